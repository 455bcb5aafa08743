#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Lists all tracked C++ files that clang-format 14 would change; exit code 1 if there are any.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

formatter=$(command -v clang-format-14 || command -v clang-format || true)
if [[ -z $formatter || $("$formatter" --version) != *"version 14."* ]]; then
  echo "check_format.sh: clang-format 14 not found; run scripts/install_packages.sh --test" >&2
  exit 2
fi

offenders=()
checked=0
while IFS= read -r -d '' file; do
  if [[ ! -f $file ]]; then continue; fi # removed, not yet committed
  checked=$((checked + 1))
  if ! "$formatter" --dry-run --Werror "$file" >/dev/null 2>&1; then offenders+=("$file"); fi
done < <(git ls-files -z -- '*.h' '*.cpp')

if ((checked == 0)); then
  echo "check_format.sh: no C++ files found in git" >&2
  exit 2
fi
if ((${#offenders[@]} > 0)); then
  echo "not formatted (run clang-format -i):" >&2
  printf '%s\n' "${offenders[@]}"
  exit 1
fi
echo "format: $checked files are correctly formatted"
