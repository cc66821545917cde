// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <string>

namespace vdb_madf::detail {

/// A script element that is data: no browser runs it.
/// @param text base64
std::string dataElement(const std::string& id, const std::string& text);
/// A script element of JSON: '<' becomes \u003c, so that no text in it ends the element.
std::string jsonElement(const std::string& id, const std::string& json);

/// Hands over a text piece by piece, with what `replacement` says in the place of each word @NAME@
/// of upper-case letters; that is not searched again.
void fillIn(const std::string& text,
            const std::function<std::string(const std::string& name)>& replacement,
            const std::function<void(const std::string&)>& write);

}  // namespace vdb_madf::detail
