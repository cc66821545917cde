# Shared by the scripts beside it: where the program is, and what they read from its JSON.

source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
madf=${VDB_MADF_BUILD:-$source_dir/build}/tools/vdb_madf
[ -x "$madf" ] || { echo "build first: tools/demo" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# value KEY FILE: a number of a flat JSON file
value() { sed -n "s/^ *\"$1\": \([^,]*\),\{0,1\}$/\1/p" "$2"; }

# median, of the numbers on standard input
median() { sort -g | awk '{a[NR] = $1} END {print NR % 2 ? a[(NR + 1) / 2] : (a[NR / 2] + a[NR / 2 + 1]) / 2}'; }
