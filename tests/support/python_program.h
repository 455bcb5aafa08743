// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vernier::test {

/// A program in Python that answers questions: lines that read what comes before them, then, after
/// an indent of four, what it does with each: `asked` is the question, `number` counts from 0, and
/// say() answers with an object or its text.
inline std::string python_program(const std::string& start, const std::string& with_question) {
  return "import json, sys, os, time\n" + start +
         "print('{\"ready\": true}', flush=True)\n"
         "for number, line in enumerate(sys.stdin):\n"
         "    asked = json.loads(line)\n"
         "    def say(answer):\n"
         "        answer = json.loads(answer) if isinstance(answer, str) else answer\n"
         "        print(json.dumps({'question': asked['question'], **answer}), flush=True)\n"
         "    " +
         with_question + "\n";
}

/// Reads a localiser's map.
inline const std::string python_reads_map =
    "n = json.loads(sys.stdin.readline())['nodes']\n"
    "nodes = [json.loads(sys.stdin.readline()) for _ in range(n)]\n";

}  // namespace vernier::test
