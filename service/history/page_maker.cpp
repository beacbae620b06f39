#include "service/history/page_maker.hpp"

#include <stdexcept>
#include <utility>

namespace reident::history {

PageMaker::PageMaker(const HistoryQuery& query) : query_(query) {
  if (query.cursor.empty()) return;
  beyond_ = key_of_cursor(query);
  if (!beyond_)
    throw std::invalid_argument(
        "the cursor is damaged, or belongs to another question; begin again with an empty one");
}

bool PageMaker::add(const Json& row, const Json& key) {
  // Bytes that are no UTF-8 are encoded by then: nothing is replaced.
  std::string text = row.dump(-1, ' ', false, Json::error_handler_t::replace);
  is_cut_ = page_.rows.size() >= query_.page_size ||
            (!page_.rows.empty() && bytes_ + text.size() > page_bytes);
  if (is_cut_) return false;
  bytes_ += text.size();
  page_.rows.push_back(std::move(text));
  last_key_ = key;
  return true;
}

HistoryPage PageMaker::page() {
  if (is_cut_) page_.next_cursor = cursor_after(query_, last_key_);
  return std::move(page_);
}

}  // namespace reident::history
