#include "picture_output.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

std::unique_ptr<PictureOutput> make_picture_output(Player&, const PictureOptions&) { return nullptr; }

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
