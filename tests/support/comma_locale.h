// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <clocale>
#include <cstdlib>
#include <iostream>
#include <string>

#include "support/temporary_folder.h"

namespace vdb_madf::test {

/// A locale that writes decimals with a comma, as a host program may set one, for as long as this
/// lives. Where the system has none, one is made, if it has localedef and its sources (Debian:
/// locales).
class CommaLocale {
 public:
  CommaLocale() {
    isSet_ = std::setlocale(LC_ALL, kName) != nullptr;
    if (!isSet_) {
      const std::string made = folder_.file(kName);
      if (std::system(("localedef -i de_DE -f UTF-8 '" + made + "' >/dev/null 2>&1").c_str()) ==
          0) {
        ::setenv("LOCPATH", folder_.path().c_str(), 1);
        isSet_ = std::setlocale(LC_ALL, kName) != nullptr;
      }
    }
    if (!isSet_) std::cout << "SKIPPED: numbers in a locale with a comma: install locales\n";
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;
  ~CommaLocale() {
    std::setlocale(LC_ALL, "C");
    ::unsetenv("LOCPATH");
  }
  bool isSet() const { return isSet_; }

 private:
  static constexpr char kName[] = "de_DE.UTF-8";
  TemporaryFolder folder_;
  bool isSet_ = false;
};

}  // namespace vdb_madf::test
