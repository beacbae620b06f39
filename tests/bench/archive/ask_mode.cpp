#include "tests/bench/archive/modes.hpp"
#include "tests/bench/archive/plain_sqlite.hpp"

namespace reident::bench {
namespace {

struct AskOptions {
  std::string file;
  std::string extension;
  std::string sql;
  std::vector<std::int64_t> values;
};

void run(const AskOptions& options) {
  const SqliteHandle handle = open_sqlite(options.file, SQLITE_OPEN_READONLY);
  if (!options.extension.empty()) {
    sqlite3_db_config(handle.get(), SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 1, nullptr);
    check(handle.get(),
          sqlite3_load_extension(handle.get(), options.extension.c_str(), nullptr, nullptr));
  }
  const double begin = seconds_now();
  const SqliteStatement query = prepare(handle, options.sql);
  for (std::size_t i = 0; i < options.values.size(); ++i)
    sqlite3_bind_int64(query.get(), static_cast<int>(i + 1), options.values[i]);
  if (const int code = sqlite3_step(query.get()); code != SQLITE_ROW) {
    check(handle.get(), code);
    throw std::runtime_error("no answer to " + options.sql);
  }
  print({{"answer", sqlite3_column_double(query.get(), 0)}, {"ms", (seconds_now() - begin) * 1e3}});
}

}  // namespace

void add_ask(CLI::App& app) {
  auto options = std::make_shared<AskOptions>();
  CLI::App* mode = app.add_subcommand("ask", "A question in SQL that has one number for an answer");
  mode->add_option("file", options->file, "The database")->required();
  mode->add_option("sql", options->sql, "The question")->required();
  mode->add_option("--values", options->values, "Of its parameters, in their order");
  mode->add_option("--extension", options->extension, "SQLite's module to load before");
  mode->callback([options] { run(*options); });
}

}  // namespace reident::bench
