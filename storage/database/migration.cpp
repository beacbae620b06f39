#include "storage/database/migration.hpp"

#include "storage/database/schema.hpp"

namespace reident::storage {

void migrate(sqlite::Connection& connection, std::int64_t version) {
  if (version < 2) connection.execute(schema::from_1_to_2());
  if (version < 3) {
    connection.execute(schema::from_2_to_3());
    samples_to_chunks(connection);
    connection.execute(schema::without_samples_of_2());
  }
  if (version < 4) connection.execute(schema::from_3_to_4());
  if (version < 6) connection.execute(schema::from_5_to_6());
  if (version < 7) connection.execute(schema::from_6_to_7());
  if (version >= 6 && version < 8) connection.execute(schema::bias_effects_of_8());
  if (version < 8) connection.execute(schema::from_7_to_8());
  if (version >= 3 && version < 9) connection.execute(schema::chunks_of_9());
  if (version < 9) connection.execute(schema::shards_of_9());
  connection.execute(schema::series_view_of_10());
  connection.execute(schema::user_version());
}

}  // namespace reident::storage
