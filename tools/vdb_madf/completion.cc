// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <functional>
#include <iostream>
#include <memory>

#include "command.h"
#include "command_words.h"

namespace vdb_madf::tools {

namespace {

using Path = ValueWords::Path;

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

/// The text in single quotes, as each of the shells reads it.
std::string shellQuoted(const std::string& text, const std::string& quote) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? quote : std::string(1, c);
  return result + "'";
}

/// In bash and zsh a quote within quotes ends them, stands by itself and begins new ones.
std::string shellQuoted(const std::string& text) {
  return shellQuoted(text, "'\\''");
}

/// Calls `visit` for the command and all verbs; `path` is " generate snow" for a verb below a verb,
/// empty for the command.
void eachVerb(const VerbWords& verb, const std::string& path,
              const std::function<void(const VerbWords&, const std::string&)>& visit) {
  visit(verb, path);
  for (const VerbWords& below : verb.verbs) eachVerb(below, path + " " + below.name, visit);
}

/// ' convert'|' generate'|' generate snow': a pattern of a case that all verbs match.
std::string verbPattern(const VerbWords& command) {
  std::vector<std::string> paths;
  eachVerb(command, "", [&](const VerbWords&, const std::string& path) {
    if (!path.empty()) paths.push_back("'" + path + "'");
  });
  return joined(paths, "|");
}

/// What the shells bash and zsh say differently.
struct Dialect {
  std::function<std::string(const ValueWords&)> offerValue;
  std::function<std::string(const VerbWords&)> offerOptions, offerVerbs;
};

/// The body that the functions for bash and zsh have in common: `verb` is the path of verbs that
/// were given, `before` the word before the one to complete, `word` that one.
std::string cases(const VerbWords& command, const Dialect& dialect) {
  std::string text = "  case \"$verb\" in\n";
  eachVerb(command, "", [&](const VerbWords& verb, const std::string& path) {
    text += "    '" + path + "')\n      case \"$before\" in\n";
    std::vector<std::string> unknown;  // options of whose value nothing is known
    for (const OptionWords& option : verb.options) {
      if (!option.value) continue;
      const std::string names = joined(option.names, "|");
      if (option.value->path == Path::none && option.value->choices.empty())
        unknown.push_back(names);
      else
        text += "        " + names + ") " + dialect.offerValue(*option.value) + " ;;\n";
    }
    if (!unknown.empty()) text += "        " + joined(unknown, "|") + ") ;;\n";
    text += "        *)\n          if [[ \"$word\" == -* ]]; then\n            " +
            dialect.offerOptions(verb) + "\n          else\n            " +
            (verb.verbs.empty() ? dialect.offerValue(verb.argument) : dialect.offerVerbs(verb)) +
            "\n          fi ;;\n      esac ;;\n";
  });
  return text + "  esac\n";
}

std::string namesOf(const std::vector<OptionWords>& options) {
  std::string text;
  for (const OptionWords& option : options)
    text += (text.empty() ? "" : " ") + joined(option.names, " ");
  return text;
}

/// 'name:what it is', as zsh's _describe takes it.
std::string described(const std::string& name, const std::string& help) {
  return " " + shellQuoted(name + ":" + help);
}

std::string fishCondition(const std::string& path) {
  if (path.empty()) return "__fish_use_subcommand";
  std::string text = "__fish_seen_subcommand_from" + path;
  const size_t last = path.rfind(' ');
  if (last > 0)
    text = fishCondition(path.substr(0, last)) + "; and __fish_seen_subcommand_from" +
           path.substr(last);
  return text;
}

std::string fishQuoted(const std::string& text) {
  return shellQuoted(text, "\\'");
}

/// What follows the name of an option that has a value, or the condition of a verb with arguments.
std::string fishValue(const ValueWords& value) {
  std::vector<std::string> choices = value.choices;
  if (value.path == Path::folder) choices.push_back("(__fish_complete_directories)");
  return (value.path == Path::file ? "" : " -f") +
         (choices.empty() ? "" : " -a " + fishQuoted(joined(choices, " ")));
}

// Scripts that complete the words of a command line, one for each shell. They hold all words: the
// command is not run while somebody types.

std::string bashCompletion(const VerbWords& command) {
  Dialect bash;
  bash.offerValue = [](const ValueWords& value) {
    std::vector<std::string> parts;
    if (!value.choices.empty()) parts.push_back("choices='" + joined(value.choices, " ") + "'");
    if (value.path != Path::none)
      parts.push_back(value.path == Path::file ? "paths=-f" : "paths=-d");
    return parts.empty() ? ":" : joined(parts, " ");
  };
  bash.offerOptions = [](const VerbWords& verb) {
    return "choices='" + namesOf(verb.options) + "'";
  };
  bash.offerVerbs = [](const VerbWords& verb) {
    std::vector<std::string> names;
    for (const VerbWords& below : verb.verbs) names.push_back(below.name);
    return "choices='" + joined(names, " ") + "'";
  };
  const std::string function = "_" + command.name;
  return "# For bash, written by: " + command.name + " completion bash\n" + function + R"(() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} verb= choices= paths= i
  # Readline takes the = of --option=value for a word.
  if [[ $word == = ]]; then
    word=
  elif [[ $before == = ]]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$verb ${COMP_WORDS[i]}" in
      )" +
         verbPattern(command) + R"() verb+=" ${COMP_WORDS[i]}" ;;
    esac
  done
)" + cases(command, bash) +
         R"(  mapfile -t COMPREPLY < <(compgen $paths -W "$choices" -- "$word")
  [[ -z $paths ]] || compopt -o filenames 2>/dev/null
}
complete -F )" +
         function + " " + command.name + "\n";
}

std::string zshCompletion(const VerbWords& command) {
  Dialect zsh;
  zsh.offerValue = [](const ValueWords& value) {
    std::vector<std::string> calls;
    if (!value.choices.empty()) calls.push_back("compadd -- " + joined(value.choices, " "));
    if (value.path != Path::none)
      calls.push_back(value.path == Path::file ? "_files" : "_files -/");
    return calls.empty() ? ":" : joined(calls, "; ");
  };
  zsh.offerOptions = [](const VerbWords& verb) {
    std::string text = "offered=(";
    for (const OptionWords& option : verb.options)
      for (const std::string& name : option.names) text += described(name, option.help);
    return text + "); _describe -o option offered";
  };
  zsh.offerVerbs = [](const VerbWords& verb) {
    std::string text = "offered=(";
    for (const VerbWords& below : verb.verbs) text += described(below.name, below.help);
    return text + "); _describe verb offered";
  };
  const std::string function = "_" + command.name;
  return "#compdef " + command.name + "\n# For zsh, written by: " + command.name +
         " completion zsh\n" + function + R"(() {
  local word=$PREFIX before=${words[CURRENT-1]} verb= i
  local -a offered
  if [[ "$word" == --*=* ]]; then
    before=${word%%=*}
    compset -P 1 '*='
  fi
  for ((i = 2; i < CURRENT; ++i)); do
    case "$verb ${words[i]}" in
      )" +
         verbPattern(command) + R"() verb+=" ${words[i]}" ;;
    esac
  done
)" + cases(command, zsh) +
         R"(}
# Read from a folder of functions, this is the function; sourced, it says what it completes.
if [[ "${funcstack[1]}" == )" +
         function + " ]]; then\n  " + function + " \"$@\"\nelse\n  compdef " + function + " " +
         command.name + "\nfi\n";
}

std::string fishCompletion(const VerbWords& command) {
  std::string text = "# For fish, written by: " + command.name + " completion fish\n";
  eachVerb(command, "", [&](const VerbWords& verb, const std::string& path) {
    std::string condition = fishCondition(path);
    if (!verb.verbs.empty() && !path.empty()) {
      condition += "; and not __fish_seen_subcommand_from";
      for (const VerbWords& below : verb.verbs) condition += " " + below.name;
    }
    const std::string line = "complete -c " + command.name + " -n '" + condition + "'";
    for (const VerbWords& below : verb.verbs)
      text += line + " -f -a " + below.name + " -d " + fishQuoted(below.help) + "\n";
    const std::string argument = verb.verbs.empty() ? fishValue(verb.argument) : "";
    if (!argument.empty()) text += line + argument + "\n";
    for (const OptionWords& option : verb.options) {
      text += line;
      for (const std::string& name : option.names)
        text += name.compare(0, 2, "--") == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.value) text += " -r" + fishValue(*option.value);
      text += " -d " + fishQuoted(option.help) + "\n";
    }
  });
  return text;
}

}  // namespace

void addCompletion(Verb command, const CommandLine& line, Action& action) {
  Verb verb = command.verb("completion", "a script that lets a shell complete words");
  const auto shell = std::make_shared<std::string>();
  verb.option("SHELL", *shell, "the shell, which reads the script at its start")
      .oneOf({"bash", "zsh", "fish"})
      .required();
  verb.footer("Example:\n  vdb_madf completion bash > vdb_madf.bash");
  verb.onParsed([shell, &line, &action] {
    action = [shell, &line] {
      const VerbWords words = line.words();
      std::cout << (*shell == "bash"  ? bashCompletion(words)
                    : *shell == "zsh" ? zshCompletion(words)
                                      : fishCompletion(words));
    };
  });
}

}  // namespace vdb_madf::tools
