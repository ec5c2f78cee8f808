#pragma once

#include "json_reader.h"
#include "scene.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The body of that name at `key`; refused with the names there are. `deformables_only` leaves the rigid
// ones out.
BodyRef read_body_ref(ObjectReader& item, std::string_view key, const Scene& scene, bool deformables_only,
                      const std::string& doc);
// The same where the key may be absent.
std::optional<BodyRef> read_optional_body_ref(ObjectReader& item, std::string_view key, const Scene& scene,
                                              const std::string& doc);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
