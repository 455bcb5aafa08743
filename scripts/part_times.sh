# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# To be sourced by other scripts: measures wall time and CPU time of their parts (user plus system, of
# the script and its finished child processes).
#
#   begin_part NAME    ends the previous part and begins the next
#   end_parts          ends the last part
#   print_part_times   prints a table of all parts and the total
#   write_part_times   prints the same, tab-separated: NAME, wall and CPU seconds
# A name such as "run: calibrate" is a step of the part "run", which gets its own row with the sum.
# shellcheck shell=bash

part_names=()
part_wall_cs=() # hundredths of a second
part_cpu_cs=()
part_open=''
parts_begun_cs=$((${EPOCHREALTIME/[.,]/} / 10000))

wall_cs() { wall=$((${EPOCHREALTIME/[.,]/} / 10000)); }

# Fields 14 to 17 of stat are hundredths of a second; field 2 is a name in parentheses.
cpu_cs() {
  local line fields
  read -r line <"/proc/$$/stat"
  read -r -a fields <<<"${line##*) }"
  cpu=$((fields[11] + fields[12] + fields[13] + fields[14]))
}

end_parts() {
  if [[ -z $part_open ]]; then return; fi
  local wall cpu
  wall_cs
  cpu_cs
  part_names+=("$part_open")
  part_wall_cs+=($((wall - part_wall_start)))
  part_cpu_cs+=($((cpu - part_cpu_start)))
  part_open=''
}

begin_part() {
  local wall cpu
  end_parts
  part_open=$1
  wall_cs
  cpu_cs
  part_wall_start=$wall
  part_cpu_start=$cpu
  echo "== $1 ($(((wall - parts_begun_cs) / 6000)) min $(((wall - parts_begun_cs) / 100 % 60)) s)"
}

seconds_of() { printf '%d.%02d' $(($1 / 100)) $(($1 % 100)); }

write_part_times() {
  local wall cpu i whole
  local -A sum_wall=() sum_cpu=()
  for i in "${!part_names[@]}"; do
    whole=${part_names[i]%%: *}
    sum_wall[$whole]=$((${sum_wall[$whole]:-0} + part_wall_cs[i]))
    sum_cpu[$whole]=$((${sum_cpu[$whole]:-0} + part_cpu_cs[i]))
  done
  for i in "${!part_names[@]}"; do
    whole=${part_names[i]%%: *}
    if [[ -n ${sum_wall[$whole]:-} ]]; then
      printf '%s\t%s\t%s\n' "$whole" "$(seconds_of "${sum_wall[$whole]}")" \
        "$(seconds_of "${sum_cpu[$whole]}")"
      unset "sum_wall[$whole]" # print it only once
    fi
    if [[ ${part_names[i]} == *": "* ]]; then
      printf '%s\t%s\t%s\n' "${part_names[i]}" "$(seconds_of "${part_wall_cs[i]}")" \
        "$(seconds_of "${part_cpu_cs[i]}")"
    fi
  done
  wall_cs
  cpu_cs
  printf 'total\t%s\t%s\n' "$(seconds_of $((wall - parts_begun_cs)))" "$(seconds_of "$cpu")"
}

print_part_times() {
  local name wall cpu LC_ALL=C
  printf '%-66s %9s %9s\n' "part" "wall s" "CPU s"
  while IFS=$'\t' read -r name wall cpu; do
    if [[ $name == *": "* ]]; then name="  ${name#*: }"; fi
    printf '%-66.66s %9.1f %9.1f\n' "$name" "$wall" "$cpu"
  done < <(write_part_times)
}
