#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>
#include "tests/trust/group_run.hpp"
using namespace reident; using namespace reident::trust;
int main(int,char**argv){
  std::ifstream f(argv[1]); std::stringstream s; s<<f.rdbuf();
  auto parsed=parse_config(s.str(),"."); if(auto*m=std::get_if<1>(&parsed)){ for(auto&x:*m) std::printf("%s\n",x.message.c_str()); return 1;}
  Config c=std::get<0>(parsed); 
  for(auto&g:all_groups()){ auto t=std::chrono::steady_clock::now(); auto o=run_group(g,c,"/tmp/h3/scratch/run");
   for(auto&x:o) for(auto&e:x.equipment){ std::printf("%d %s %s attempts %zu drifts %zu\n",x.number,x.life.c_str(),e.equipment.c_str(),e.attempts.size(),e.drifts.size());
     std::map<std::string,int> n; for(auto&a:e.attempts) n[a.outcome]++; for(auto&[k,v]:n) std::printf("   %s %d\n",k.c_str(),v);
     for(auto&p:e.publications) std::printf("   v%ld day %.2f new %.3f old %.3f res %.3f wot %.2f\n",p.version,double(p.time-g.start)/86400e9,p.mrse_percent.value_or(-1),p.replaced_mrse_percent.value_or(-1),p.resolution_percent,p.worse_over_tolerance());
     for(auto&h:e.changes) std::printf("   change %s mattered %d orbits %ld worst %.2f\n",h.kind.c_str(),h.mattered,h.orbits,h.worst_ratio);
   }
   std::printf("%.1f s\n",std::chrono::duration<double>(std::chrono::steady_clock::now()-t).count()); std::fflush(stdout);
  }
}
