// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/bond_resistance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vdb_madf::detail {

namespace {

double radiusOf(double area) {
  return std::sqrt(area / M_PI);
}

}  // namespace

std::vector<double> contactResistances(double volume, const std::vector<Contact>& contacts) {
  std::vector<double> result;
  for (const Contact& contact : contacts) {
    if (contact.area == 0) {  // opposite faces can cancel one another
      result.push_back(std::numeric_limits<double>::infinity());
      continue;
    }
    const double length = contact.arm.length(), radius = radiusOf(contact.area);
    if (length == 0) {  // in the middle of the grain, as of one that lies within it
      result.push_back(1 / (4 * radius));
      continue;
    }
    const openvdb::Vec3d along = contact.arm / length;
    double all = 0;
    for (const Contact& other : contacts) {
      const double reach = other.arm.dot(along);
      all += other.area * reach * reach;
    }
    const double section = contact.area * length * length / all * volume / length;
    const double open = std::max(0.0, 1 - radius / radiusOf(section));
    result.push_back(length / section + open * std::sqrt(open) / (4 * radius));
  }
  return result;
}

}  // namespace vdb_madf::detail
