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
#include "service/dds/middleware_log.hpp"
#include "service/support/command_line.hpp"
#include "service/support/log.hpp"
#include "service/support/stop_signal.hpp"
#include "service/web/site.hpp"

namespace {

using namespace reident;

constexpr int exit_failed = 1;
constexpr int exit_bad_request = 2;
constexpr std::uint16_t usual_port = 8480;
constexpr unsigned query_threads = 2;
constexpr std::size_t query_queue = 32;

struct Arguments {
  std::string config, accounts, audit, security, fleet;
  bool hash_password = false;
  web::ServerOptions server;
};

int serve(const Config& config, const Arguments& arguments, web::Accounts accounts,
          const StopSignal& signal) {
  const dds::Endpoint endpoint{
      config.domain, config.partition,
      arguments.security.empty() ? config.security : std::filesystem::path(arguments.security)};
  web::LiveState live(endpoint, config.database);
  web::Access access(std::move(accounts));
  web::Audit audit(arguments.audit);
  web::FleetView fleet(arguments.fleet);
  // Both end behind the threads of the pool and of the desk, which answer through them.
  std::optional<web::HttpServer> server;
  std::optional<web::Site> site;
  {
    web::QueryPool pool(config.database, query_threads, query_queue);
    web::OrderDesk orders(endpoint, addressee(config));
    site.emplace(web::Site::Parts{config, live, pool, access, orders, audit, fleet,
                                  [&server] { return server->counts(); }});
    server.emplace(
        arguments.server,
        [&site](web::HttpRequest&& request, web::Respond respond) {
          site->handle(std::move(request), std::move(respond));
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

void declare(CLI::App& app, Arguments& arguments) {
  web::ServerOptions& options = arguments.server;
  app.add_option("--security", arguments.security,
                 "on a secured domain: folder of the page's certificate")
      ->envname("REIDENT_SECURITY");
  app.name("reident-web");
  app.add_option("-c,--config", arguments.config,
                 "the service's configuration: its database, DDS domain, partition and name");
  app.add_option("--fleet", arguments.fleet,
                 "folder of the configurations of a site, such as /etc/reident: the page also "
                 "shows how all of its spacecraft are")
      ->check(CLI::ExistingDirectory);
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
  app.add_option("--user-header", options.user_header,
                 "header in which the proxy on the Unix socket names who asks");
  app.add_option("--accounts", arguments.accounts,
                 "file of who may order what (service/web/README.md); without, nobody may");
  app.add_option("--audit", arguments.audit, "file that gets each refusal, a JSON object a line");
  app.add_flag("--hash-password", arguments.hash_password,
               "read a password from standard input and print what the file of accounts takes");
  app.add_option("--max-connections", options.connections, "connections in all")
      ->capture_default_str();
  app.add_option("--max-connections-of-address", options.connections_of_address,
                 "connections of one address")
      ->capture_default_str();
}

/// Prints the mistakes of a file.
int refuse(const std::string& file, const std::vector<ConfigMistake>& mistakes) {
  for (const ConfigMistake& mistake : mistakes)
    std::cerr << fmt::format("{}:{}: {}\n", file, mistake.line, mistake.message);
  return exit_bad_request;
}

int refuse(const std::string& why) {
  std::cerr << fmt::format("reident-web: {}\n", why);
  return exit_bad_request;
}

int print_hash() {
  std::string password;
  std::getline(std::cin, password);
  if (password.empty()) return refuse("there is no password on standard input");
  std::cout << web::hash_password(password) << std::endl;
  return 0;
}

int run(const Arguments& arguments, const StopSignal& signal) {
  if (arguments.hash_password) return print_hash();
  if (arguments.config.empty()) return refuse("--config is required; see reident-web --help");
  if (!arguments.server.user_header.empty() && arguments.server.socket.empty())
    return refuse("--user-header is trusted on a Unix socket alone; add --socket");
  const auto loaded = load_config(arguments.config);
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded))
    return refuse(arguments.config, *mistakes);
  const auto& config = std::get<Config>(loaded);
  web::Accounts accounts;
  if (!arguments.accounts.empty()) {
    auto read = web::load_accounts(arguments.accounts);
    if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&read))
      return refuse(arguments.accounts, *mistakes);
    accounts = std::get<web::Accounts>(std::move(read));
  }
  log::set_level(config.log_level);
  try {
    return serve(config, arguments, std::move(accounts), signal);
  } catch (const web::ServerError& error) {
    return refuse(error.what());
  } catch (const std::exception& error) {
    log::error("web", "cannot run", {{"error", error.what()}});
    return exit_failed;
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  dds::log_what_the_middleware_says();
  const StopSignal signal;
  CLI::App app(
      "Serves the operators' page: how all models are, on what evidence, and what waits.\n"
      "It reads the service's database, and orders only for those whom a file of accounts "
      "names.\n\n"
      "Example:\n  reident-web --config reident.toml\n");
  Arguments arguments;
  declare(app, arguments);
  if (const auto status = parse_command_line(app, argc, argv)) return *status;
  return run(arguments, signal);
}
