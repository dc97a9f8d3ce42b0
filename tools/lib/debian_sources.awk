# Debian's own suites from apt's source files, one-line and deb822, as `deb` and `deb-src` lines.
# Usage: awk -f debian_sources.awk -v suites=bookworm FILES...
# Entries of others (another suite name, no component main, a key that is not Debian's) are left out.

function is_debian_suite(suite) {
   sub(/\/$/, "", suite)
   return suite == suites || suite == suites "-updates" || suite == suites "-security" \
      || suite ~ /^(old)?stable(-updates|-security)?$/ || suite == suites "/updates"
}

function emit(options, uri, suite, components) {
   if (!is_debian_suite(suite) || " " components " " !~ / main /) return
   if (options ~ /signed-by=/ && options !~ /debian-archive|debian-keyring/) return
   line = (options == "" ? "" : "[" options "] ") uri " " suite " main"
   if (line in seen) return
   seen[line] = 1
   print "deb " line
   print "deb-src " line
}

function flush_stanza(    i, j, n, m, uri, suite, options) {
   if (field["types"] != "" && tolower(field["enabled"]) != "no") {
      # An inline key block has no file name to pass on; apt's trusted keys then decide.
      if (field["signed-by"] ~ /^ *\//) options = "signed-by=" squeeze(field["signed-by"])
      n = split(squeeze(field["uris"]), uri, " ")
      m = split(squeeze(field["suites"]), suite, " ")
      for (i = 1; i <= n; i++)
         for (j = 1; j <= m; j++) emit(options, uri[i], suite[j], squeeze(field["components"]))
   }
   split("", field)
   name = ""
}

function squeeze(text) {
   gsub(/[ \t]+/, " ", text)
   sub(/^ /, "", text)
   sub(/ $/, "", text)
   return text
}

function one_line(text,    part, n, i, options, components) {
   if (text !~ /^deb(-src)?[ \t]/) return
   sub(/[ \t]+#.*$/, "", text)
   if (match(text, /\[[^]]*\]/)) {
      options = squeeze(substr(text, RSTART + 1, RLENGTH - 2))
      text = substr(text, 1, RSTART - 1) substr(text, RSTART + RLENGTH)
   }
   n = split(squeeze(text), part, " ")
   for (i = 4; i <= n; i++) components = components " " part[i]
   emit(options, part[2], part[3], squeeze(components))
}

FNR == 1 { flush_stanza() }
FILENAME !~ /\.sources$/ { one_line($0); next }
/^[ \t]*$/ { flush_stanza(); next }
/^#/ { next }
/^[ \t]/ { field[name] = field[name] " " $0; next }
{
   name = tolower(substr($0, 1, index($0, ":") - 1))
   field[name] = substr($0, index($0, ":") + 1)
}
END { flush_stanza() }
