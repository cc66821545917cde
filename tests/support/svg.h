// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <regex>
#include <string>

namespace vdb_madf::test {

/// How many parts of a drawing have a property, such as "stroke:rgb(0%,44.705882%,69.803922%)" or
/// "stroke-dasharray:2,3". Cairo 1.16 writes these as styles, 1.18 as attributes.
inline int countInSvg(const std::string& svg, const std::string& property) {
  std::string styles = std::regex_replace(svg, std::regex("=\""), ":");
  styles = std::regex_replace(styles, std::regex("(stroke-dasharray:[0-9]+) "), "$1,");
  styles = std::regex_replace(styles, std::regex(", "), ",");
  int found = 0;
  for (size_t at = styles.find(property); at != std::string::npos;
       at = styles.find(property, at + 1))
    ++found;
  return found;
}

}  // namespace vdb_madf::test
