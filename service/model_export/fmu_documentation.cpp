#include <fmt/format.h>

#include "service/model_export/fmu_text.hpp"
#include "service/support/time_text.hpp"

namespace reident::model_export {
namespace {

std::string rows_of(const std::vector<FmuVariable>& variables, std::string_view kind) {
  std::string text;
  for (const FmuVariable& variable : variables)
    text += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        xml_text(variable.name), kind, xml_text(variable.unit),
                        xml_text(variable.description));
  return text;
}

constexpr const char* about_expressions =
    "<p>A parameter that stands in expressions alone has no unit here and starts at 1: a version "
    "keeps "
    "the operating point of inputs, not of what they are computed from. Set it before the first "
    "step.</p>\n";

constexpr const char* behaviour = R"(<h2>What a step does</h2>
<p>The model is sampled: x[k+1] = A x[k] + B (u[k] - u0), y[k] = C x[k] + D (u[k] - u0) + y0, with a
tick every {0} s, the first at the start time. There x is state[1], state[2] and so on, which can be set
before the first step; x = 0 is the operating point. A step over [t, t + h) runs the ticks in it, each
with the inputs that are set. At a tick the outputs are those of that time, with the inputs that are set;
between ticks those of the last tick hold. So a step of one period gives the outputs of its end. A step
of several periods runs several ticks with inputs held, or changing by their derivatives where those
are set. An output that follows its inputs at once (D is not 0) needs the inputs of the end of a step:
by FMI 3.0 set them in event mode, by FMI 2.0 set their derivatives, or take steps of a tenth of a
period. Ticks are counted in whole periods: rounding of the
times that are handed in neither adds nor loses one, and what lies within a millionth of a period of a
tick is on it. Inputs outside of the range that they were identified in are used as they are.</p>
<h2>What it is not</h2>
<p>This is the free run: outputs follow from inputs alone. A tracking gain or a Kalman gain that the
version has, which correct a model by live telemetry, are in model.json and not in the binary.</p>
<p>Where an expression has no finite value (a division by zero), its input keeps its last one, at first
the operating point, and the step gives a warning. An input that is set to what is not finite keeps its
value (discarded), as does the whole model where a step would leave what a double can hold. A call
that the standard does not allow gives an error and changes nothing. All say why by the logger. There
are no directional derivatives.</p>
<h2>Compile it elsewhere</h2>
<pre>cc -std=c11 -O2 -ffp-contract=off -fPIC -fvisibility=hidden -shared sources/reident_fmu.c -lm -o {1}.so</pre>
<p>in the folder binaries/PLATFORM of that machine. sources/{1}.c is the same with the prefix {1}_ to the
name of each function, for programs that link FMUs statically. resources/model.txt holds the numbers;
sources/model_file.h says how.</p>
)";

}  // namespace

std::string fmu_documentation(const ExportedVersion& exported, const FmuVariables& variables) {
  const ModelVersion& version = exported.version;
  const EquipmentModel& model = version.model;
  const std::string name =
      xml_text(fmt::format("{}/{} version {}", model.spacecraft, model.equipment, version.number));
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"UTF-8\"/>"
             "<title>{0}</title></head>\n<body>\n<h1>{0}</h1>\n"
             "<p>Identified from telemetry ({1}); {2}, decided {3} by {4}. Digest {5}. "
             "<a href=\"model.json\">model.json</a> is the whole version.</p>\n"
             "<table>\n<tr><th>variable</th><th></th><th>unit</th><th></th></tr>\n",
             name, xml_text(model.method), xml_text(exported.status), time_text(version.decided),
             xml_text(version.decided_by), version.digest) +
         rows_of(variables.inputs, "input") + rows_of(variables.outputs, "output") +
         rows_of(variables.states, "state") + "</table>\n" +
         (has_expressions(model.inputs) ? about_expressions : "") +
         fmt::format(behaviour, model.dynamics.period_s, model_identifier(version)) +
         "</body>\n</html>\n";
}

}  // namespace reident::model_export
