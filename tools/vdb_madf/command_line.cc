// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "vdb_madf/files/file_name.h"

namespace vdb_madf::tools {

namespace {

std::string givenBelow(const CLI::App& app) {
  const std::string& name = app.get_name();
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  return verbs.empty() ? name : name + " " + givenBelow(*verbs.front());
}

/// The innermost verb that was given.
const CLI::App& lastVerb(const CLI::App& app) {
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  return verbs.empty() ? app : lastVerb(*verbs.front());
}

/// Shorter beginnings could be anything.
constexpr size_t kShortestBeginning = 3;

/// Optimal string alignment: Levenshtein's distance with exchanges of neighbors.
size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> least(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i)
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        least[i][j] = i + j;
        continue;
      }
      least[i][j] = std::min({least[i - 1][j] + 1, least[i][j - 1] + 1,
                              least[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        least[i][j] = std::min(least[i][j], least[i - 2][j - 2] + 1);
    }
  return least[a.size()][b.size()];
}

/// The name that was most likely meant: one that begins with what was given, else the one that
/// takes the fewest single letters put in, left out, replaced or exchanged with the next, at most
/// a third of what was given. (A tie: the first.)
std::optional<std::string> nearestName(const std::string& given,
                                       const std::vector<std::string>& names) {
  std::optional<std::string> nearest;
  size_t least = given.size() / 3 + 1;
  for (const std::string& name : names) {
    const bool begins =
        given.size() >= kShortestBeginning && name.compare(0, given.size(), given) == 0;
    const size_t steps = begins ? 0 : distance(given, name);
    if (steps >= least) continue;
    least = steps;
    nearest = name;
  }
  return nearest;
}

std::string didYouMean(const std::string& given, const std::vector<std::string>& names) {
  const auto name = nearestName(given, names);
  return name ? ": did you mean " + *name + "?" : "";
}

std::string unknownOption(const CLI::App& verb, const std::string& argument) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  const std::string given = argument.substr(0, argument.find('='));
  if (verb.get_option_no_throw(given)) return given + ": write options after the verb";
  return "there is no option " + given + didYouMean(given, names);
}

std::string unknownVerb(const CLI::App& app, const std::string& given) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands(nullptr)) names.push_back(verb->get_name());
  return "there is no verb " + given + didYouMean(given, names);
}

/// What is wrong with the arguments that nothing took, the likeliest cause first: a misspelt verb,
/// then a misspelt option, whose value may have been taken for something else. Empty if nothing is
/// left over.
std::string unexpected(const CLI::App& app) {
  const std::vector<std::string> arguments = app.remaining(true);
  if (arguments.empty()) return "";
  const CLI::App& verb = lastVerb(app);
  if (!verb.get_subcommands(nullptr).empty() && arguments.front().front() != '-')
    return unknownVerb(verb, arguments.front());
  for (const std::string& argument : arguments)
    if (argument.size() > 1 && argument.front() == '-') return unknownOption(verb, argument);
  std::string list;
  for (const std::string& argument : arguments) list += (list.empty() ? "" : " ") + argument;
  return "not expected: " + list;
}

/// In the order in which the parser takes them, the last first. "help VERB" is "VERB --help".
std::vector<std::string> argumentsOf(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (!arguments.empty() && arguments.front() == "help") {
    arguments.erase(arguments.begin());
    arguments.push_back("--help");
  }
  return {arguments.rbegin(), arguments.rend()};
}

/// Takes a folder "name/", as shells complete it, for "name". Arguments are files; options are left
/// as they are.
CLI::Option* takePaths(CLI::Option* option) {
  if (option->get_positional()) option->transform(withoutSlash);
  return option;
}

/// Refuses what the library would take for an octal or hexadecimal number, as 060.
CLI::Option* takeDecimals(CLI::Option* option) {
  const auto decimal = [](const std::string& text) {
    const size_t first = text.find_first_not_of("+-");
    const bool isOther = first + 1 < text.size() && text[first] == '0';
    return isOther ? text + " begins with 0: give a whole number in decimal digits" : "";
  };
  return option->check(decimal);
}

/// What a value is, by the name that the help shows for it. Arguments are files.
ValueWords valueWords(const CLI::Option& option, const Choices& choices) {
  ValueWords words;
  if (const auto known = choices.find(&option); known != choices.end())
    words.choices = known->second;
  const std::string type = option.get_type_name();
  if (type == "DIR")
    words.path = ValueWords::Path::folder;
  else if (type.compare(0, 4, "FILE") == 0 || type == "REGION" ||
           (option.get_positional() && words.choices.empty()))
    words.path = ValueWords::Path::file;
  return words;
}

VerbWords verbWords(const CLI::App& app, const Choices& choices) {
  VerbWords words;
  words.name = app.get_name();
  words.help = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) {
      words.argument = valueWords(*option, choices);
      continue;
    }
    OptionWords& added = words.options.emplace_back();
    for (const std::string& name : option->get_snames()) added.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) added.names.push_back("--" + name);
    added.help = option->get_description();
    if (option->get_items_expected_max() > 0) added.value = valueWords(*option, choices);
  }
  for (const CLI::App* verb : app.get_subcommands(nullptr))
    words.verbs.push_back(verbWords(*verb, choices));
  return words;
}

/// The help as CLI11 2.1 writes it: later ones have other headings and reflow texts, by version.
class HelpText : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    std::string usage = make_usage(app, std::move(name));
    usage = usage.substr(usage.find_first_not_of('\n'));
    if (usage.rfind("Usage:", 0) != 0) usage = "Usage: " + usage;
    usage.resize(usage.find('\n') + 1);
    std::string groups =
        make_positionals(app) + make_groups(app, mode) + make_subcommands(app, mode);
    for (const auto& [newer, heading] : {std::pair("\nPOSITIONALS:\n", "\nPositionals:\n"),
                                         std::pair("\nOPTIONS:\n", "\nOptions:\n"),
                                         std::pair("\nSUBCOMMANDS:\n", "\nSubcommands:\n")}) {
      const size_t at = groups.find(newer);
      if (at != std::string::npos) groups.replace(at, std::strlen(newer), heading);
    }
    const std::string footer = app->get_footer();
    return make_description(app) + usage + groups + "\n" + (footer.empty() ? "" : footer + "\n");
  }
  std::string make_option(const CLI::Option* option, bool isPositional) const override {
    std::string type = make_option_opts(option);
    const std::string preset = option->get_default_str(), newer = " [" + preset + "] ";
    const size_t at = preset.empty() ? std::string::npos : type.find(newer);
    if (at != std::string::npos) type.replace(at, newer.size(), "=" + preset);
    return line(option->get_name(isPositional, !isPositional) + type, make_option_desc(option));
  }
  std::string make_subcommand(const CLI::App* app) const override {
    return line(app->get_name(), app->get_description());
  }

 private:
  std::string line(const std::string& name, const std::string& description) const {
    const size_t width = get_column_width();
    std::string text = "  " + name;
    if (text.size() >= width && !description.empty()) text += "\n" + std::string(width, ' ');
    if (text.size() < width) text.resize(width, ' ');
    for (const char c : description)
      text += c == '\n' ? c + std::string(width, ' ') : std::string(1, c);
    return text + "\n";
  }
};

}  // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::typeName(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::showDefault() {
  option_->capture_default_str();
  return *this;
}

Option& Option::oneOf(const std::vector<std::string>& values) {
  option_->check(CLI::IsMember(values));
  return offer(values);
}

Option& Option::offer(const std::vector<std::string>& values) {
  (*choices_)[option_] = values;
  return *this;
}

template <typename Number>
Option& Option::range(Number low, Number high) {
  option_->check(CLI::Range(low, high));
  return *this;
}
template Option& Option::range(int, int);
template Option& Option::range(int64_t, int64_t);
template Option& Option::range(double, double);

Option& Option::notNegative() {
  option_->check(CLI::NonNegativeNumber);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Verb Verb::verb(const std::string& name, const std::string& description) {
  app_->require_subcommand(0, 1);  // without any, main.cc says what is missing
  return Verb(app_->add_subcommand(name, description), choices_);
}

Option Verb::option(const std::string& name, std::string& value, const std::string& help) {
  return Option(takePaths(app_->add_option(name, value, help)), choices_);
}

template <typename Number>
Option Verb::option(const std::string& name, Number& value, const std::string& help) {
  CLI::Option* const option = app_->add_option(name, value, help);
  return Option(std::is_integral_v<Number> ? takeDecimals(option) : option, choices_);
}
template Option Verb::option(const std::string&, int&, const std::string&);
template Option Verb::option(const std::string&, uint64_t&, const std::string&);
template Option Verb::option(const std::string&, int64_t&, const std::string&);
template Option Verb::option(const std::string&, double&, const std::string&);

Option Verb::option(const std::string& name, std::vector<std::string>& values,
                    const std::string& help) {
  return Option(takePaths(app_->add_option(name, values, help)), choices_);
}

void Verb::flag(const std::string& name, bool& value, const std::string& help) {
  app_->add_flag(name, value, help);
}

Option Verb::repeatedOption(const std::string& name, GivenOptions& given, const std::string& help) {
  return Option(
      app_->add_option_function<std::string>(
              name, [&given, name](const std::string& value) { given.emplace_back(name, value); },
              help)
          ->trigger_on_parse(),
      choices_);
}

void Verb::repeatedFlag(const std::string& name, GivenOptions& given, const std::string& help) {
  app_->add_flag_function(
          name, [&given, name](int64_t) { given.emplace_back(name, ""); }, help)
      ->trigger_on_parse();
}

void Verb::footer(const std::string& text) {
  app_->footer(text);
}

void Verb::onParsed(std::function<void()> call) {
  app_->callback(std::move(call));
}

CommandLine::CommandLine(const std::string& name, const std::string& description,
                         const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->set_version_flag("--version", name + " " + version);
  app_->formatter(std::make_shared<HelpText>());
  app_->get_formatter()->column_width(34);
  app_->get_formatter()->label("SUBCOMMAND", "VERB");
  app_->get_formatter()->label("Subcommands", "Verbs");
}

CommandLine::~CommandLine() = default;

Verb CommandLine::command() {
  return Verb(app_.get(), &choices_);
}

std::optional<std::string> CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argumentsOf(argc, argv));
  } catch (const CLI::CallForHelp&) {
    const std::string unknown = app_->get_subcommands().empty() ? unexpected(*app_) : "";
    if (unknown.empty()) return app_->help();
    throw WrongUsage(unknown + " (see " + given() + " --help)");
  } catch (const CLI::CallForVersion& version) {
    return version.what() + std::string("\n");
  } catch (const CLI::ParseError& error) {
    const std::string unknown = unexpected(*app_);
    throw WrongUsage((unknown.empty() ? error.what() : unknown) + " (see " + given() + " --help)");
  }
  return std::nullopt;
}

std::string CommandLine::given() const {
  return givenBelow(*app_);
}

VerbWords CommandLine::words() const {
  VerbWords command = verbWords(*app_, choices_);
  VerbWords help;
  help.name = "help";
  help.help = "explain a verb";
  for (const VerbWords& verb : command.verbs) help.argument.choices.push_back(verb.name);
  command.verbs.push_back(help);
  return command;
}

}  // namespace vdb_madf::tools
