// reident-web: the operators' page.

#include <csignal>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stop_token>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "service/config/config.hpp"
#include "service/support/log.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/version.hpp"
#include "service/web/site.hpp"

namespace {

using namespace reident;

constexpr int exit_failed = 1;
constexpr int exit_bad_request = 2;
constexpr std::uint16_t usual_port = 8480;
constexpr unsigned query_threads = 2;
constexpr std::size_t query_queue = 32;

int serve(const Config& config, const web::ServerOptions& options, const StopSignal& signal) {
  web::LiveState live({config.domain, config.partition}, config.database);
  std::optional<web::HttpServer> server;  // ends behind the pool, whose threads answer through it
  {
    web::QueryPool pool(config.database, query_threads, query_queue);
    web::Site site(config, live, pool, [&server] { return server->counts(); });
    server.emplace(
        options,
        [&site](web::HttpRequest&& request, web::Respond respond) {
          site.handle(std::move(request), respond);
        },
        live);
    bool is_deaf = false;
    std::thread hearing([&] {
      try {
        live.run([&server] { server->notify(); });
      } catch (const dds::Error& error) {
        log::error("web", "cannot hear the service", {{"error", error.what()}});
        is_deaf = true;
        server->stop();
      }
    });
    const std::stop_callback stop(signal.token(), [&server] { server->stop(); });
    log::info("web", "serves", {{"url", server->url()}});
    std::cout << server->url() << std::endl;
    server->run();
    if (signal.number() != 0)
      log::info("web", "asked to stop", {{"signal", strsignal(signal.number())}});
    live.stop();
    hearing.join();
    return is_deaf ? exit_failed : 0;
  }
}

void declare(CLI::App& app, std::string& config, web::ServerOptions& options) {
  app.name("reident-web");
  app.set_version_flag("--version", std::string(program_version()));
  app.add_option("-c,--config", config,
                 "the service's configuration: its database, DDS domain, partition and name")
      ->required();
  app.add_option("--address", options.address,
                 "IP address to listen on; one that is not loopback needs --certificate")
      ->capture_default_str();
  options.port = usual_port;
  app.add_option("--port", options.port, "0: any that is free; it is printed")
      ->capture_default_str();
  app.add_option("--socket", options.socket, "Unix socket to listen on, in the place of TCP");
  app.add_option("--certificate", options.certificate, "PEM file: TLS");
  app.add_option("--key", options.key, "PEM file with its key, where it is another one");
  app.add_option("--client-authority", options.client_authority,
                 "PEM file: clients have certificates of this authority");
  app.add_option("--name", options.names,
                 "host name that browsers ask by, in addition to the "
                 "address");
  app.add_option("--max-connections", options.connections, "connections in all")
      ->capture_default_str();
  app.add_option("--max-connections-of-address", options.connections_of_address,
                 "connections of one address")
      ->capture_default_str();
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  const StopSignal signal;
  CLI::App app(
      "Serves the operators' page: how all models are, on what evidence, and what waits.\n"
      "It reads the service's database and changes nothing.\n\n"
      "Example:\n  reident-web --config reident.toml\n");
  std::string path;
  web::ServerOptions options;
  declare(app, path, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_bad_request;
  }
  const auto loaded = load_config(path);
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded)) {
    for (const ConfigMistake& mistake : *mistakes)
      std::cerr << fmt::format("{}:{}: {}\n", path, mistake.line, mistake.message);
    return exit_bad_request;
  }
  const auto& config = std::get<Config>(loaded);
  log::set_level(config.log_level);
  try {
    return serve(config, options, signal);
  } catch (const web::ServerError& error) {
    std::cerr << fmt::format("reident-web: {}\n", error.what());
    return exit_bad_request;
  } catch (const std::exception& error) {
    log::error("web", "cannot run", {{"error", error.what()}});
    return exit_failed;
  }
}
