#include "tests/trust/scenario.hpp"
namespace reident::trust {
std::vector<LifeGroup> all_groups() {
  LifeGroup g; g.seed=2; g.start=1'498'867'200'000'000'000; g.duration=4*86400ll*1000000000;
  g.scenarios={{1,"none",{}}};
  LifeGroup h=g; h.life="efficiency_drift"; auto t=g.start+10*86400ll*1000000000; auto e=satcs::reference::usual(satcs::reference::LifeKind::efficiency_drift,t,t); e.magnitude=1; h.events={e};
  auto e2=satcs::reference::usual(satcs::reference::LifeKind::failed_cell,t,t); h.events.push_back(e2);
  h.scenarios[0].number=2;
  return {g};
}
}
