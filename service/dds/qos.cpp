#include "service/dds/qos.hpp"

#include <new>

namespace reident::dds {
namespace {

Qos make_qos() {
  Qos qos(dds_create_qos());
  if (!qos) throw std::bad_alloc();
  return qos;
}

Qos reliable_qos(const Profile& profile) {
  Qos qos = make_qos();
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE,
                       std::chrono::nanoseconds(write_slice).count());
  if (profile.history == keep_all) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  } else {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, profile.history);
  }
  if (profile.lease.count() > 0) {
    dds_qset_ownership(qos.get(), DDS_OWNERSHIP_EXCLUSIVE);
    dds_qset_liveliness(qos.get(), DDS_LIVELINESS_MANUAL_BY_TOPIC,
                        std::chrono::nanoseconds(profile.lease).count());
  }
  return qos;
}

}  // namespace

Qos partition_qos(const std::string& partition) {
  Qos qos = make_qos();
  dds_qset_partition1(qos.get(), partition.c_str());
  return qos;
}

Qos writer_qos(const Profile& profile, const WriterOptions& options) {
  Qos qos = reliable_qos(profile);
  const std::int32_t late_joiners =
      profile.history == keep_all ? options.history : profile.late_joiners;
  dds_qset_writer_data_lifecycle(qos.get(), profile.autodispose);
  if (profile.lease.count() > 0) dds_qset_ownership_strength(qos.get(), options.strength);
  if (profile.lifespan.count() > 0)
    dds_qset_lifespan(qos.get(), std::chrono::nanoseconds(profile.lifespan).count());
  if (late_joiners == 0) {
    dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
    return qos;
  }
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  // The default keeps one sample whatever the history is.
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, late_joiners,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  return qos;
}

Qos reader_qos(const Profile& profile, const ReaderOptions& options, bool transient_local) {
  Qos qos = reliable_qos(profile);
  dds_qset_durability(qos.get(),
                      transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (profile.history == keep_all && options.keep_last > 0) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, options.keep_last);
  } else if (profile.history == keep_all) {
    dds_qset_resource_limits(qos.get(), options.max_samples, DDS_LENGTH_UNLIMITED,
                             DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

}  // namespace reident::dds
