#include "service/dds/entity.hpp"

namespace reident::dds {
namespace {

const char* remedy(dds_return_t code) {
  switch (code) {
    case DDS_RETCODE_OUT_OF_RESOURCES:
      return "free memory or file descriptors, or raise the limits of the process";
    case DDS_RETCODE_INCONSISTENT_POLICY:
      return "use bounds above 0 that agree with the history";
    case DDS_RETCODE_PRECONDITION_NOT_MET:
      return "use one IDL for the topic in the whole domain";
    case DDS_RETCODE_NOT_ALLOWED_BY_SECURITY:
      return "permit it in the participant's DDS security permissions";
    case DDS_RETCODE_TIMEOUT:
      return "look for a reader that hangs, or for a network that loses everything";
    case DDS_RETCODE_ALREADY_DELETED:
    case DDS_RETCODE_BAD_PARAMETER:
      return "keep the participant longer than its readers and writers, and give valid values";
    default:
      return "look at the middleware's own message above, and at CYCLONEDDS_URI if it is set";
  }
}

}  // namespace

void fail(dds_return_t code, const std::string& call, const std::string& about) {
  throw Error(call + " failed for " + about + ": " + dds_strretcode(code) + "; " + remedy(code));
}

}  // namespace reident::dds
