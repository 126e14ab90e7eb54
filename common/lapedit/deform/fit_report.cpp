// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/fit_report.h"

#include <algorithm>

#include "lapedit/base/format_text.h"

namespace lapedit {

std::string FitDistances::text() const {
  return format_text("%.3g %% matched, distance RMS %.3g, median %.3g, 95 %% %.3g, largest %.3g", 100 * matched, rms,
                     median, most, largest);
}

std::string FitReport::text() const {
  std::string lines = "Fit to " + scan + ", mode " + mode + "; alignment: " + aligned;
  if (by_landmarks) {
    lines += " by landmarks";
  }
  lines += format_text(", scale %.4g, RMS %.3g of the nearest 80 %%", scale, alignment);
  if (second) {
    lines += format_text(" (another orientation: %.3g)", *second);
  }
  lines += format_text("; %d stages, %d rounds", stages, rounds);
  if (reversed_normals) {
    lines += "; the scan's normals were taken as reversed";
  }
  return lines + "\nTemplate to scan: " + to_scan.text() + "\nScan to template: " + from_scan.text() + "\n";
}

std::string FitReport::advice() const {
  constexpr double kOtherUnit = 5, kHalf = 0.5, kAmbiguous = 1.05, kMany = 0.15, kFar = 0.02, kContradict = 0.6;
  if (std::max(size_ratio, 1 / size_ratio) > kOtherUnit) {
    return format_text("The scan is %.3g times as large as the template: check whether both have the same unit.",
                       size_ratio);
  }
  if (by_landmarks && *by_landmarks > kContradict) {
    return format_text(
        "The landmarks do not match: after the alignment their distances to the targets are %.3g of those of the "
        "targets to their mean (RMS): check that each has the target that belongs to it, and that left and right are "
        "not "
        "exchanged.",
        *by_landmarks);
  }
  if (std::min(to_scan.matched, from_scan.matched) < kHalf) {
    const bool ours = to_scan.matched < from_scan.matched;
    return format_text("Only %.3g %% of the ", 100 * std::min(to_scan.matched, from_scan.matched)) +
           (ours ? "template found a partner on the scan" : "scan found a partner on the template") +
           ": check the alignment, and that normals point outwards, or give landmarks.";
  }
  if (opposed > kMany) {
    return format_text(
        "The normals of %.3g %% of the scan point to the other side than the rest: orient its faces coherently, for "
        "example with MeshLab's filter \"Re-Orient all faces coherently\".",
        100 * opposed);
  }
  if (from_scan.rms > kFar * size) {
    return format_text(
        "Parts of the scan are still far from the template (RMS %.3g): remove inner layers and what does not belong to "
        "the object, or give landmarks.",
        from_scan.rms);
  }
  if (second && *second < kAmbiguous * alignment) {
    return format_text(
        "Another orientation fits almost as well after the alignment (RMS %.3g and %.3g): check that the template is "
        "not upside down, turned round or a mirror image, or give three landmarks.",
        *second, alignment);
  }
  if (mode == "pose" && landmarks < 3) {
    return "Without landmarks limbs can be matched to the wrong parts of the scan: check them, or give landmarks at "
           "their ends.";
  }
  return {};
}

}  // namespace lapedit
