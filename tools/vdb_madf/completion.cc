// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <iostream>

#include "command.h"
#include "completion_script.h"

namespace vdb_madf::tools {

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
