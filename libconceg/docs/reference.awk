# SPDX-License-Identifier: BSD-3-Clause
# The reference of the C API from the headers' comments: man pages (one per header, a link per name) and one HTML page.
#   awk -v folder=man3 -v html=api.html -v symbols=symbols.tsv -f reference.awk HEADERS
#   awk -v check=1 -f reference.awk HEADERS       # functions without a docstring; exit 1 when there are any
# A block comment belongs to the declarations below it, up to an empty line; a comment at the end of a line to that line.
BEGIN {
  if (symbols != "") {
    while ((getline line < symbols) > 0) {
      n = split(line, column, "\t")
      if (n >= 4 && line !~ /^#/) since[column[2]] = column[4]
    }
  }
  if (!check) {
    print "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width\"><title>ConCeG: C API</title>" > html
    print "<style>body{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}pre{background:#f4f4f4;padding:.6em;overflow:auto}" > html
    print "h2{border-top:1px solid #999;padding-top:1em}small{color:#666}nav a{margin-right:1em}</style><h1>ConCeG: C API</h1><p>Made from the headers' comments.<nav>" > html
    for (i = 1; i < ARGC; i++) {
      name = ARGV[i]; sub(/.*\//, "", name)
      if (name ~ /[.]h$/) printf "<a href=\"#%s\">%s</a> ", name, name > html
    }
    print "</nav>" > html
  }
}

FNR == 1 {
  end_page()
  name = FILENAME; sub(/.*\//, "", name)
  title = ""; note = ""; inside = ""; body = 0
}

# The body of an inline function ends at its closing brace in the first column.
body { if (/^}/) body = 0; next }

inside == "comment" { add_comment($0); next }
inside == "declaration" { add_declaration($0); next }

/^[ \t]*$/ { note = ""; next }
/^\/\*/ { inside = "comment"; text = ""; sub(/^\/\* ?/, ""); add_comment($0); next }
/^(CONCEG_API|CONCEG_EXPORT|static inline|typedef|#define CONCEG_[A-Z0-9_]+ )/ {
  if (/_H$/) next
  inside = "declaration"; declared = ""; depth = 0
  add_declaration($0)
  next
}

END {
  end_page()
  if (check) {
    printf "%d functions in %d headers, %d without a docstring\n", functions, headers, missing
    exit missing > 0 || functions == 0
  }
}

function add_comment(line,   closed) {
  closed = sub(/ *\*\/.*$/, "", line)
  sub(/^ *\* ?/, "", line)
  if (line !~ /SPDX/) text = text == "" ? line : text " " line
  if (!closed) return
  inside = ""
  if (title == "") { title = text; begin_page(); return }
  if (text !~ /^----/) note = text
}

# A declaration ends at its semicolon; an inline function at its opening brace.
function add_declaration(line,   code, opens) {
  declared = declared (declared == "" ? "" : "\n") line
  code = line; gsub(/\/\*.*\*\//, "", code)
  if (declared ~ /^#define/) {
    if (line ~ /\\$/) return
    finish("constant"); return
  }
  if (declared ~ /^static inline/ && code ~ /\{[^}]*$/) {
    body = 1; sub(/ *\{[^{]*$/, ";", declared); finish("function"); return
  }
  opens = gsub(/\{/, "{", code); depth += opens - gsub(/\}/, "}", code)
  if (depth == 0 && code ~ /[;}] *$/) {
    if (declared ~ /^static inline/) { sub(/ *\{.*$/, ";", declared) }
    finish(declared ~ /^typedef/ ? "type" : "function")
  }
}

function name_of(kind, code,   found) {
  if (kind == "constant") { split(code, found, " "); sub(/\(.*/, "", found[2]); return found[2] }
  if (match(code, /\(\*conceg_[a-z0-9_]+/)) { if (kind == "type" && code !~ /\{/) return substr(code, RSTART + 2, RLENGTH - 2) }
  if (kind == "function" && match(code, /conceg_[a-z0-9_]+\(/)) return substr(code, RSTART, RLENGTH - 1)
  if (match(code, /conceg_[a-z0-9_]+;[^;]*$/)) { code = substr(code, RSTART); sub(/;.*/, "", code); return code }
  return ""
}

function finish(kind,   entry, own, lines) {
  inside = ""
  entry = name_of(kind, declared)
  if (entry == "") return
  own = note
  if (own == "" && kind == "function" && match(declared, /\/\*.*\*\//)) own = substr(declared, RSTART + 3, RLENGTH - 6)
  if (kind == "function") {
    functions++
    if (own == "") { missing++; if (check) print name ": " entry " has no docstring" }
  }
  if (check) return
  if (declared !~ /^#define/) gsub(/(CONCEG_API|CONCEG_EXPORT) /, "", declared)
  if (declared !~ /^#define/) gsub(/[ \n]*(CONCEG_NODISCARD|CONCEG_PRINTF\([0-9, ]*\))/, "", declared)
  printf ".SS %s\n.nf\n%s\n.fi\n", roff(entry), roff(declared) > page
  if (own != "") printf ".PP\n%s\n", roff(own) > page
  if (entry in since) printf ".PP\nSince %s.\n", since[entry] > page
  printf "<h3 id=\"%s\">%s%s</h3><pre>%s</pre>%s\n", entry, entry, entry in since ? " <small>since " since[entry] "</small>" : "", markup(declared), own == "" ? "" : "<p>" markup(own) > html
  if (kind != "constant") { printf ".so man3/conceg_%s.3\n", name > (folder "/" entry ".3"); close(folder "/" entry ".3") }
}

function begin_page() {
  headers++
  if (check) return
  page = folder "/conceg_" name ".3"
  printf ".TH CONCEG_%s 3 \"\" \"ConCeG\" \"ConCeG C API\"\n.SH NAME\nconceg_%s \\- header conceg/%s of libconceg\n.SH SYNOPSIS\n#include <conceg/%s>\n.SH DESCRIPTION\n%s\n.SH DECLARATIONS\n", toupper(name), name, name, name, roff(title) > page
  printf "<h2 id=\"%s\">conceg/%s</h2><p>%s\n", name, name, markup(title) > html
}

function end_page() {
  if (page != "") { print ".SH SEE ALSO\n.BR conceg (1)" > page; close(page) }
  page = ""
}

function roff(s) {
  gsub(/\\/, "\\e", s); gsub(/-/, "\\-", s)
  gsub(/\n\./, "\n\\\\\\&.", s); gsub(/\n'/, "\n\\\\\\&'", s)
  return s
}

function markup(s) { gsub(/&/, "\\&amp;", s); gsub(/</, "\\&lt;", s); gsub(/>/, "\\&gt;", s); return s }
