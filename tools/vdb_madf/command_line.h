// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command_words.h"
#include "wrong_usage.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace vdb_madf::tools {

/// Values that are offered where words are completed.
using Choices = std::map<const CLI::Option*, std::vector<std::string>>;

/// Names and values of options.
using GivenOptions = std::vector<std::pair<std::string, std::string>>;

/// What more there is to say of an option, after Verb::option(). Its calls can be chained.
class Option {
 public:
  Option(CLI::Option* option, Choices* choices) : option_(option), choices_(choices) {}

  Option& required();
  /// What the help shows in the place of the value.
  Option& typeName(const std::string& name);
  /// The help shows the value that the variable has now.
  Option& showDefault();
  Option& oneOf(const std::vector<std::string>& values);
  /// Offers these values where words are completed; others are not refused here.
  Option& offer(const std::vector<std::string>& values);
  /// Requires a value from `low` to `high`, both included. NaN passes.
  /// Numbers are int, int64_t or double.
  template <typename Number>
  Option& range(Number low, Number high);
  Option& notNegative();
  Option& excludes(const Option& other);

 private:
  CLI::Option* option_;
  Choices* choices_;
};

/// A verb, or the command itself: what its options and arguments are. The variables live until the
/// command line is parsed.
class Verb {
 public:
  Verb(CLI::App* app, Choices* choices) : app_(app), choices_(choices) {}

  /// A verb below this one; at most one of them is given.
  Verb verb(const std::string& name, const std::string& description);
  /// An option ("--size" or "-s,--size") or, without dashes, an argument by its place.
  Option option(const std::string& name, std::string& value, const std::string& help);
  /// Numbers are int, int64_t, uint64_t or double.
  template <typename Number>
  Option option(const std::string& name, Number& value, const std::string& help);
  /// An option of one or more values.
  Option option(const std::string& name, std::vector<std::string>& values, const std::string& help);
  void flag(const std::string& name, bool& value, const std::string& help);
  /// An option or a flag that may be given again and again: adds its name, as it stands here, and
  /// its value to a list that several share, in the order in which they are given.
  Option repeatedOption(const std::string& name, GivenOptions& given, const std::string& help);
  void repeatedFlag(const std::string& name, GivenOptions& given, const std::string& help);
  /// Text below the help.
  void footer(const std::string& text);
  /// Called when the verb was given and its options have their values; may throw WrongUsage.
  void onParsed(std::function<void()> call);

 private:
  CLI::App* app_;
  Choices* choices_;
};

/// The command line as a whole. This is the one file that knows the library which parses it: its
/// header takes longer to compile than most of our files.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description, const std::string& version);
  ~CommandLine();

  Verb command();
  /// @return what is to be printed instead of any work, the help or the version
  /// @throw WrongUsage
  std::optional<std::string> parse(int argc, char** argv);
  /// "vdb_madf segment": the command and the verbs that were given, after parse().
  std::string given() const;
  /// All words that it knows.
  VerbWords words() const;

 private:
  Choices choices_;
  std::unique_ptr<CLI::App> app_;
};

}  // namespace vdb_madf::tools
