# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
#
# awk -f plotly_subset.awk pass=1 plotly.js pass=2 LICENCE plotly.js
# Extracts what the report page needs (scatter, bar, heatmap, contour) from a plotly.js bundled with
# browserify. The bundle is an object of modules, number: [function, {name: number}]; modules that are
# no longer reachable from its entry are removed. Other bundles are left unchanged.

function is_edge(line) {  # between two modules
  return line ~ /^},\{.*\}\],[0-9]+:\[function\(_dereq_,module,exports\)\{$/
}
function is_end(line) { return line ~ /^},\{.*\}\]\},\{\},\[[0-9]+\]\)\([0-9]+\)$/ }

function number_after(edge) {
  sub(/:\[function\([^:]*$/, "", edge)
  sub(/^.*,/, "", edge)
  return edge
}

function uses_before(edge) {
  sub(/^},/, "", edge)
  sub(/\}\].*$/, "}", edge)
  return edge
}

function first_quoted(text) {
  sub(/^[^"']*["']/, "", text)
  sub(/["'].*$/, "", text)
  return text
}

function find_reached(   head, tail, rest, one, name) {
  queue[tail = 1] = entry
  reached[entry] = 1
  for (head = 1; head <= tail; ++head) {
    rest = uses[queue[head]]
    while (match(rest, /"[^"]*":[0-9]+/)) {
      one = substr(rest, RSTART, RLENGTH)
      rest = substr(rest, RSTART + RLENGTH)
      name = first_quoted(one)
      sub(/^.*:/, "", one)
      if ((queue[head] == entry && !(name in wanted)) || one in reached) continue
      reached[one] = 1
      queue[++tail] = one
    }
  }
}

BEGIN {
  split("./core ./bar ./heatmap ./contour", names, " ")
  for (i in names) wanted[names[i]] = 1
  first = "1:[[]function[(]_dereq_,module,exports[)][{]$"
}

pass == 1 {
  if (!module && match($0, first)) module = 1
  if (module && is_edge($0)) {
    uses[module] = uses_before($0)
    module = number_after($0)
  } else if (module && is_end($0)) {  # nested bundles have ends too: use the last one
    uses[module] = uses_before($0)
    entry = $0
    gsub(/^.*\(|\)$/, "", entry)
    last = FNR
  }
  next
}

!started {
  started = 1
  module = 0
  whole = !last
  if (!whole) find_reached()
}
/^\/\/.*(Copyright|License)/ { sub(/^\/\//, "//!") }  # esbuild keeps comments that begin with //!
FNR == 1 && /^\/\*\*$/ { sub(/\*$/, "!") }
whole { print; next }
!module && match($0, first) {
  print substr($0, 1, RSTART - 1)
  module = 1
  if (module in reached) print substr($0, RSTART)
  next
}
module && is_edge($0) {
  if (module in reached) print "}," uses_before($0) "],"
  module = number_after($0)
  if (module in reached) print module ":[function(_dereq_,module,exports){"
  next
}
module && is_end($0) && FNR == last {
  if (module in reached) print "}," uses_before($0) "]"
  print "},{},[" entry "])(" entry ")"
  module = 0
  next
}
module == entry && /^    _dereq_\('/ && !(first_quoted($0) in wanted) { next }
!module || module in reached { print }
