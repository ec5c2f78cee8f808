#include "figure_motion_files.h"

#include <algorithm>
#include <system_error>

#include "softpoint/core/atomic_file.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

FigureMotionFiles::FigureMotionFiles(const Player& player, const std::filesystem::path& folder)
    : player_(player), folder_(folder) {
  if (player.figure_count() == 0) {
    throw Error(player.scene().file + ": no figures; permitted with --bvh is one at least");
  }
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  for (std::size_t k = 0; k < player.figure_count(); ++k) {
    check_writable(file(k));
    clips_.emplace_back(player.figure(k).animation().model(), player.scene().world.time_step);
  }
  record();
}

void FigureMotionFiles::record() {
  for (std::size_t k = 0; k < clips_.size(); ++k)
    clips_[k].add(player_.figure(k).controller().state().q.data());
}

std::vector<std::string> FigureMotionFiles::write() const {
  std::vector<std::string> files;
  for (std::size_t k = 0; k < clips_.size(); ++k) {
    write_atomically(file(k), figure::bvh_text(clips_[k].clip()));
    files.push_back(file(k));
  }
  return files;
}

// Named like the figure, what no file system may take replaced.
std::filesystem::path FigureMotionFiles::file(std::size_t figure) const {
  std::string name = player_.scene().figures[figure].name;
  for (char& c : name) {
    if (c == '/' || static_cast<unsigned char>(c) < ' ') c = '_';
  }
  const auto same = [&](const FigureSpec& other) {
    return other.name == player_.scene().figures[figure].name;
  };
  const auto& all = player_.scene().figures;
  if (name.empty() || std::count_if(all.begin(), all.end(), same) > 1) name += std::to_string(figure);
  return folder_ / (name + ".bvh");
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
