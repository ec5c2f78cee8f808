#include "contact.h"

#include <functional>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

bool same(const Contact& a, const Contact& b) {
  return a.body == b.body && a.object == b.object && a.child == b.child && a.kind == b.kind &&
         a.rigid_feature == b.rigid_feature && a.skin_feature == b.skin_feature;
}

std::size_t hash(const Contact& c) {
  // Addresses differ between runs, so they may choose a slot but never an order: only the position in
  // the contact list, which follows detection, decides the order of work.
  std::size_t h = std::hash<const void*>{}(c.object);
  for (const std::size_t part : {std::size_t(c.child), std::size_t(c.body), std::size_t(c.kind),
                                 std::size_t(c.rigid_feature + 1), std::size_t(c.skin_feature + 1)}) {
    h = (h ^ part) * std::size_t{0x9E3779B97F4A7C15u};
    h ^= h >> 29;
  }
  return h;
}

}  // namespace

void ContactTable::clear() {
  contacts_.clear();
  rebuild();
}

std::size_t ContactTable::slot(const Contact& identity) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = hash(identity) & mask;
  while (slots_[i] >= 0 && !same(contacts_[static_cast<std::size_t>(slots_[i])], identity)) {
    i = (i + 1) & mask;
  }
  return i;
}

Contact* ContactTable::find(const Contact& identity) {
  if (slots_.empty()) {
    return nullptr;
  }
  const int index = slots_[slot(identity)];
  return index < 0 ? nullptr : &contacts_[static_cast<std::size_t>(index)];
}

Contact& ContactTable::find_or_add(const Contact& identity) {
  if (Contact* known = find(identity)) {
    return *known;
  }
  contacts_.push_back(identity);
  if (2 * contacts_.size() > slots_.size()) {
    rebuild();
  } else {
    slots_[slot(identity)] = static_cast<int>(contacts_.size()) - 1;
  }
  return contacts_.back();
}

void ContactTable::rebuild() {
  std::size_t size = slots_.empty() ? 64 : slots_.size();
  while (size < 4 * contacts_.size()) {
    size *= 2;
  }
  slots_.assign(size, -1);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    slots_[slot(contacts_[i])] = static_cast<int>(i);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
