#include "service/sweep/engines.hpp"

#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include "service/support/output_file.hpp"
#include "service/sweep/tasks.hpp"

namespace reident::sweep {
namespace {

namespace fs = std::filesystem;

/// As one word of a shell.
std::string quoted(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// What the command printed, without its last line end.
std::string output_of(const std::string& command) {
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no program can be started: " + command);
  std::string text;
  char buffer[256];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
  if (::pclose(pipe) != 0)
    throw std::runtime_error(
        "sbatch failed, and what it printed says why; is this a node of the cluster, with "
        "slurm-client? The command was: " +
        command);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string option_of(TaskKind kind) {
  return kind == TaskKind::candidates ? "--task" : "--judge";
}

fs::path write_script(const Plan& plan, TaskKind kind) {
  const fs::path logs = plan.folder / "logs";
  fs::create_directories(logs);
  const fs::path script = plan.folder / fmt::format("{}.sbatch", name(kind));
  OutputFile file(script);
  file.write(
      fmt::format("#!/bin/sh\n"
                  "#SBATCH --job-name=reident-{0} --cpus-per-task=1 --requeue --open-mode=append\n"
                  "#SBATCH --output={1}/{0}-%a.txt\n"
                  "exec {2} sweep {3} {4} \"$SLURM_ARRAY_TASK_ID\"\n",
                  name(kind), logs.string(), quoted(fs::canonical("/proc/self/exe").string()),
                  quoted(plan.folder.string()), option_of(kind)));
  file.finish();
  return script;
}

std::string job_of(const Plan& plan, const std::string& image, TaskKind kind, std::size_t tasks) {
  const std::string folder = plan.folder.string();
  return fmt::format(
      "apiVersion: batch/v1\n"
      "kind: Job\n"
      "metadata:\n"
      "  name: reident-sweep-{digest}-{kind}\n"
      "spec:\n"
      "  completionMode: Indexed\n"
      "  completions: {tasks}\n"
      "  parallelism: {tasks}\n"
      "  backoffLimit: {retries}\n"
      "  suspend: {suspend}\n"
      "  template:\n"
      "    spec:\n"
      "      restartPolicy: OnFailure\n"
      "      containers:\n"
      "        - name: reident\n"
      "          image: \"{image}\"\n"
      "          command: [\"reident\", \"sweep\", \"{folder}\", \"{option}\", "
      "\"$(JOB_COMPLETION_INDEX)\"]\n"
      "          resources:\n"
      "            requests: {{cpu: \"1\"}}\n"
      "          volumeMounts:\n"
      "            - {{name: sweep, mountPath: \"{folder}\"}}\n"
      "      volumes:\n"
      "        - name: sweep\n"
      "          persistentVolumeClaim: {{claimName: reident-sweep}}\n",
      fmt::arg("digest", plan.digest.substr(0, 10)), fmt::arg("kind", name(kind)),
      fmt::arg("tasks", tasks), fmt::arg("retries", 6 * tasks),
      fmt::arg("suspend", kind == TaskKind::judgement), fmt::arg("image", image),
      fmt::arg("folder", folder), fmt::arg("option", option_of(kind)));
}

}  // namespace

std::string array_of(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
    if (last > i) text += fmt::format("-{}", numbers[last]);
    i = last + 1;
  }
  return text;
}

std::vector<std::string> submit_to_slurm(const Plan& plan) {
  std::vector<std::string> jobs;
  for (const TaskKind kind : {TaskKind::candidates, TaskKind::judgement}) {
    const TaskStates now = states(plan, kind);
    if (now.left.empty()) continue;
    std::string command = "sbatch --parsable --array=" + array_of(now.left);
    if (!jobs.empty()) command += " --dependency=afterany:" + jobs.back();
    jobs.push_back(output_of(command + " " + quoted(write_script(plan, kind).string())));
  }
  return jobs;
}

std::string kubernetes_manifest(const Plan& plan, const std::string& image) {
  for (const Config& config : plan.configurations)
    if (config.database.parent_path() != plan.folder)
      throw std::invalid_argument(
          fmt::format("the archive {} is not in {}, which is what the pods mount: plan the sweep "
                      "with --copy",
                      config.database.string(), plan.folder.string()));
  return job_of(plan, image, TaskKind::candidates, plan.candidates.size()) + "---\n" +
         job_of(plan, image, TaskKind::judgement, plan.spacecraft.size());
}

}  // namespace reident::sweep
