// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Types.h>

#include <vector>

namespace vdb_madf::detail {

/// Where a current enters or leaves a grain: a bond, or a face of the box that cuts it.
struct Contact {
  openvdb::Vec3d arm;  ///< from the grain's centroid to the middle of the contact
  double area = 0;
};

/// Resistance from the centroid of a grain of unit conductivity to each of its contacts: of a tube,
/// and of the constriction at its end.
///
/// The tube of contact c is as long as its arm d, and its section is h V / d. V is the volume of
/// the grain and h its share: a d^2 / sum of a_k (r_k . u)^2, with areas a, arms r and the
/// direction u of this arm. So two opposite contacts share the grain by halves, and contacts all
/// around conduct a uniform gradient as the grain's material does. At the contact, a disc of radius
/// a at the end of a tube of radius b, the current narrows: (1 - a / b)^1.5 / 4 a (Cooper, Mikic &
/// Yovanovich 1969).
std::vector<double> contactResistances(double volume, const std::vector<Contact>& contacts);

}  // namespace vdb_madf::detail
