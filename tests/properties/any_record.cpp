#include "tests/properties/any_record.hpp"

#include <algorithm>

namespace reident::test {

Setting any_setting(const SettingLimits& limits) {
  Noise noise(*rc::gen::arbitrary<std::uint32_t>());
  const int n = any_of(1, limits.order + 1);
  const int m = any_of(1, limits.inputs + 1);
  const int p = any_of(1, limits.outputs + 1);
  return {random_system(noise, n, m, p, limits.max_modulus), noise};
}

void cut(Record& record, int parts) {
  std::vector<Index> edges{0, record.rows()};
  for (int cuts = any_of(0, parts); cuts > 0; --cuts)
    edges.push_back(any_of<Index>(1, record.rows()));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  record.segments.clear();
  std::int64_t tick = any_of(-3000, 3000);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    record.segments.push_back({edges[i], edges[i + 1], tick});
    tick += edges[i + 1] - edges[i] + *rc::gen::element(1, 3, 20, 300, 5000);
  }
}

Record with_segments_reversed(const Record& record) {
  Record result{record.period_s, record.u, record.y, {}};
  Index row = 0;
  std::int64_t tick = 0;
  for (auto from = record.segments.rbegin(); from != record.segments.rend(); ++from) {
    const Index size = from->size();
    result.segments.push_back({row, row + size, tick});
    result.u.middleRows(row, size) = record.u.middleRows(from->begin, size);
    result.y.middleRows(row, size) = record.y.middleRows(from->begin, size);
    row += size;
    tick += size + 10;
  }
  return result;
}

}  // namespace reident::test
