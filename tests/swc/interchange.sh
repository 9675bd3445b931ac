#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# SWC-plus as an interchange: a document goes out as a folder of cells and comes back byte for byte; edits win and are said; files that
# do not fit together are refused; plain files of others become documents.  interchange.sh BIN SOURCE
bin=$1 source=$2
. "$source/tests/cli/expect.sh"
t=$expect_folder
PATH=$bin:$PATH
export PATH
cd "$t" || exit 1
conceg run "$source/tests/pipe/small.yaml" --until relax -q --checkpoint made -o relaxed.cgx || exit 1
conceg analyse relaxed.cgx --points 1000 -q -o measured.cgx || exit 1
grown=made/03-grow.cgx

# There and back, for documents with bars, spheres, statistics and what others have added.
python=${CONCEG_PYTHON:-python3}
if "$python" -c 'import h5py' 2> /dev/null; then
  cp measured.cgx others.cgx
  "$python" - << 'PY'
import h5py, numpy
with h5py.File("others.cgx", "r+") as f:
    f["x_lab/numbers"] = numpy.array([[1.5, -0.0], [5e-324, 1e300]])
    f["x_lab/numbers"].attrs["unit"] = "um"
    f["x_lab/numbers"].attrs["made_by"] = "somebody"
    f["x_lab/big"] = numpy.array([2**64 - 1, 2**53 + 1], dtype="u8")
    f["x_lab/big"].attrs["unit"] = ""
    f["x_lab/low"] = numpy.array([-2**63], dtype="i8")
    f["x_lab/low"].attrs["unit"] = ""
    f["x_lab/empty"] = numpy.zeros((0, 3), dtype="f4")
    f["x_lab/empty"].attrs["unit"] = "um"
    f["x_lab/words"] = numpy.array(["", "a \"quoted\" \\ word", "gr\u00fcn\tline\nbreak", "long " * 200], dtype=h5py.string_dtype())
    f["x_lab/words"].attrs["unit"] = ""
    f["skeleton/x_charge"] = numpy.arange(len(f["skeleton/radius"]), dtype="f8") / 7
    f["skeleton/x_charge"].attrs["unit"] = "1"
PY
  cp measured.cgx odd.cgx
  "$python" - << 'PY'
import h5py, numpy
with h5py.File("odd.cgx", "r+") as f:
    f["x_lab/pairs"] = numpy.zeros(2, dtype=[("a", "f8"), ("b", "i4")])
    f["x_lab"].attrs["made by"] = "somebody"
PY
  expect 0 "without .*/x_lab/pairs.*/x_lab@made by" conceg export --to swc --dir odd odd.cgx
  expect 0 "" conceg import swc odd -o odd-back.cgx
  # No provenance, a group of a newer version, no point in any skeleton: still the same bytes.
  cp $grown newer.cgx && cp $grown bare.cgx && chmod u+w newer.cgx bare.cgx
  "$python" - << 'PY'
import h5py, numpy
with h5py.File("newer.cgx", "r+") as f:
    f["spines/count"] = numpy.array([3, 4], dtype="u4")
    f["spines/count"].attrs["unit"] = ""
with h5py.File("bare.cgx", "r+") as f:
    for name, column in list(f["skeleton"].items()):
        unit = column.attrs["unit"]
        empty = numpy.zeros(len(column), "u8") if name == "cell_offset" else column[:0]
        del f["skeleton"][name]
        f["skeleton"][name] = empty
        f["skeleton"][name].attrs["unit"] = unit
    del f["skeleton/branch"]
PY
  # strip brings both into the canonical form.
  conceg strip provenance newer.cgx -q -o newer-canonical.cgx && conceg strip recipe bare.cgx -q -o bare-canonical.cgx || exit 1
  expect_true "the newer document keeps its group and has no provenance" sh -c 'conceg info newer-canonical.cgx | grep -q spines && ! conceg info newer-canonical.cgx | grep -q /provenance/'
  conceg strip statistics others.cgx -q -o canonical.cgx && set -- $grown relaxed.cgx measured.cgx canonical.cgx newer-canonical.cgx bare-canonical.cgx
else
  echo "SKIPPED: no h5py: groups of others are not carried through SWC-plus"
  set -- $grown relaxed.cgx measured.cgx
fi
for document; do
  rm -rf out
  expect 0 "" conceg export --to swc --dir out "$document"
  expect_true "$document: no line is longer than 700 characters" sh -c 'test "$(cat out/swc/*.swc | wc -L)" -le 700'
  expect_true "every row is a plain row or a comment" sh -c '! grep -hv "^#" out/swc/*.swc | grep -vq "^[0-9]* [0-9]* -*[0-9.]* -*[0-9.]* -*[0-9.]* [0-9.]* -*[0-9]*$"'
  expect 0 "" conceg import swc out -o back.cgx
  expect_same "$document" back.cgx
  expect 0 "" conceg import swc $(ls -r out/swc/*.swc) -o back.cgx
  expect_same "$document" back.cgx
done
rm -rf out
conceg export --to swc --dir out $grown -q
for threads in 1 2; do
  expect 0 "" sh -c "conceg import swc out | conceg relax -q --threads $threads > via.cgx"
  expect_same via.cgx relaxed.cgx
done

# What a folder cannot carry is said; a part of the cells or wrapped pieces are no document.
conceg run "$source/tests/pipe/small.yaml" --until triangulate -q -o network.cgx
conceg grow network.cgx --set keep=[network] -q -o kept.cgx 2> /dev/null
expect 0 "without /network" conceg export --to swc --dir kept kept.cgx
conceg export --to swc --wrapped --dir wrapped -q $grown
expect_true "wrapped pieces carry no document" sh -c '! grep -q @cgx wrapped/swc/*.swc'

# Edits.
first=$(ls out/swc/*.swc | head -1) second=$(ls out/swc/*.swc | tail -1)
changed() { rm -rf edited && cp -r out edited && for f in edited/swc/*.swc; do sed -i "$1" "$f"; done; }
changed '5s/^\([0-9]* [0-9]* \)\S* /\13.250000 /'
expect 0 "W_STALE" conceg import swc edited -o edited.cgx
expect 0 "" conceg validate edited.cgx
expect_true "the edit wins" sh -c 'conceg dump /skeleton/position edited.cgx | grep -q "3.25"'
conceg export --to swc --dir spheres -q relaxed.cgx
sed -i '5s/^\([0-9]* [0-9]* \)\S* /\13.250000 /' "$(ls spheres/swc/*.swc | head -1)"
expect 0 "/spheres is left out: the cells that it was made from were edited" conceg import swc spheres -o edited.cgx
expect_true "no spheres of another skeleton" sh -c '! conceg dump /spheres edited.cgx > /dev/null 2>&1'
# Types, links and somas that another tool has changed are seen too, and an edited document says in /provenance that it was imported.
fresh_copy() { rm -rf edited && cp -r measured edited && file=edited/swc/$(basename "$first"); }
conceg export --to swc --dir measured -q measured.cgx
said() { # said "what the warning says"
  expect 0 "$1" conceg import swc edited -o edited.cgx
  expect_true "$1: spheres and statistics are gone" sh -c 'conceg dump edited.cgx > edited.txt && ! grep -q -e "^/spheres/" -e "^/statistics/" edited.txt'
  expect_true "$1: the last row of the provenance is import" sh -c 'conceg dump /provenance/stage edited.cgx | tail -1 | grep -q import'
  expect 0 "" conceg validate edited.cgx
}
fresh_copy; sed -i '6s/^\([0-9]*\) 3 /\1 2 /' "$file"; said "0000.*.swc:6: W_STALE: type or parent of 1 samples"
fresh_copy; sed -i '9s/ [0-9]*$/ 2/' "$file"; said "0000.*.swc:9: W_STALE: type or parent of 1 samples"
fresh_copy; sed -i '/^1 1 /d' "$file"; said "0000.*.swc: W_STALE: the soma is another"
expect_true "a soma that was taken away is gone" sh -c 'conceg dump /cells/radius edited.cgx | sed -n 2p | grep -qx " *0"'
fresh_copy; sed -i 's/^\(1 1 .* \)[0-9.]* -1$/\12.500000 -1/' "$file"; said "/statistics is left out: the cells that it was made from were edited"
fresh_copy; expect 0 "" conceg import swc edited -o edited.cgx; expect_same edited.cgx measured.cgx
# A tip is taken away: the last sample of the file.
rm -rf edited && cp -r out edited
last=$(grep -v '^#' "$second" | tail -1 | cut -d' ' -f1)
sed -i "/^$last /d" "edited/swc/$(basename "$second")"
expect 0 "samples were added, removed" conceg import swc edited -o edited.cgx
expect 0 "" conceg validate edited.cgx
expect 0 "" conceg relax edited.cgx -o again.cgx
# A cell is taken away, a cell of another document is put in, a plain cell is put in.
rm -rf edited && cp -r out edited && rm "edited/swc/$(basename "$second")"
expect 0 "1 of the document's 3 cells have no file here" conceg import swc edited -o edited.cgx
expect 0 "" conceg validate edited.cgx
rm -rf edited && cp -r out edited && rm "edited/swc/$(basename "$first")"
expect 3 "the file of cell 0.* is not among the 2 files" conceg import swc edited -o x.cgx
rm -rf edited && cp -r out edited && cp "$(ls spheres/swc/*.swc | tail -1)" "edited/swc/$(basename "$second")"
expect 3 "are of two documents" conceg import swc edited -o x.cgx
rm -rf edited && cp -r out edited && cp "$second" edited/swc/twin.swc
expect 3 "are both cell 2 of the document" conceg import swc edited -o x.cgx
rm -rf edited && cp -r out edited && printf '1 1 0 0 0 5 -1\n2 3 6 0 0 1 1\n' > edited/swc/plain.swc
expect 3 "plain.swc: is a plain SWC file" conceg import swc edited -o x.cgx

# Blocks that are broken: every one is refused with the file and the array, and takes no memory for what it claims.
broken() { rm -rf edited && cp -r out edited && sed -i "$1" "edited/swc/$(basename "$first")"; }
broken '/@cgx end/d'; expect 3 "cell_0000.*: (@cgx document .*: )?expected (one block|'@cgx end')" conceg import swc edited -o x.cgx
broken 's/^# @array \/cells\/id u64 \[1\]/# @array \/cells\/id u64 [1000000000000000]/'; expect 3 "/cells/id u64 .*: expected at most four extents" conceg import swc edited -o x.cgx
broken 's/^# @array \/cells\/id u64 \[1\]/# @array \/cells\/id u64 [900000000000]/'; expect 3 "/cells/id: expected 900000000000 values, got 1" sh -c "ulimit -v 4000000; conceg import swc edited -o x.cgx"
broken 's/^# @array \/cells\/id u64/# @array \/cells\/id u65/'; expect 3 "expected a type such as f64" conceg import swc edited -o x.cgx
broken '/^# @array \/cells\/id/{n;s/.*/# @values many/}'; expect 3 "/cells/id: expected numbers of its type" conceg import swc edited -o x.cgx
broken 's/^# @array \/types\/name text \[3\]/# @array \/types\/name text [2]/'; expect 3 "/types/name: expected 2 values, got 3" conceg import swc edited -o x.cgx
broken 's/^# @text "conceg: 1/# @text conceg: 1/'; expect 3 "expected a quoted text" conceg import swc edited -o x.cgx
broken 's/^# @cgx cell \([0-9a-f]*\) 0 3/# @cgx cell \1 5 3/'; expect 3 "expected the number of the cell" conceg import swc edited -o x.cgx
broken '/^# @array \/bars\/state/{n;s/.*/# @values 9/}'; expect_true "values that break a rule are refused" sh -c '! conceg import swc edited -o x.cgx 2> log; grep -q "error:" log; test ! -e x.cgx'
expect_true "nothing was written by any of these" test ! -e x.cgx

# Plain files: the fixtures of the reader.
printf '# a cell\n1 1 10 20 30 5 -1\n2 4 10 20 36 1 1\n3 4 10 20 60 0.8 2\n4 5 12 20 70 0.5 3\n' > plain.swc
expect 0 "" conceg import swc plain.swc -o plain.cgx
expect 0 "" conceg validate plain.cgx
conceg dump plain.cgx > plain.txt
for line in '"pyramidal"' '/domain@periodic u8.3.: 0 0 0' '/provenance/stage'; do expect_true "the document says $line" grep -qE -e "$line" plain.txt; done
expect 0 "" conceg relax plain.cgx -o plain-relaxed.cgx
expect 0 "" conceg import swc --class microglia plain.swc -o plain.cgx
expect 0 "" conceg dump /types/class plain.cgx
expect_output microglia
sed 's/ 0.8 2$/ 0 2/' plain.swc > thin.swc
expect 3 "thin.swc:4: expected a radius above 0, got 0; give --radius-min-um" conceg import swc thin.swc -o x.cgx
expect 0 "1 radii below 0.1 um were raised" conceg import swc --radius-min-um 0.1 thin.swc -o thin.cgx
expect 3 "E_COLUMNS" sh -c "echo '1 1 0' > short.swc; conceg import swc short.swc -o x.cgx"
expect 2 "gif: unknown format; there are: swc" conceg import gif x.gif -o x.cgx
expect 2 "which format" conceg import -o x.cgx
expect 2 "which files" conceg import swc -o x.cgx
expect 3 "expected files that end in .swc, got none" sh -c "mkdir none; conceg import swc none -o x.cgx"
expect 4 "nowhere.swc: cannot be opened" conceg import swc nowhere.swc -o x.cgx
if [ -d "${CONCEG_SHARED:-/nowhere}/goldens/morphology" ]; then
  expect 0 "" conceg import swc --radius-min-um 0.1 "$CONCEG_SHARED/goldens/morphology" -o real.cgx
  expect 0 "" conceg validate real.cgx
else echo "SKIPPED: CONCEG_SHARED is not set: no real cells imported"; fi

# The files are plain SWC for other readers.
if "$python" -c 'import importlib.util, sys; sys.exit(not all(map(importlib.util.find_spec, ("morphio", "navis", "neurom"))))' 2> /dev/null; then
  printf '1 1 0 0 0 5 -1\r2 3 6 0 0 1 1\r3 3 7 0 0 1 2\r' > cr_only.swc
  expect 0 "" "$python" "$source/tests/swc/peers.py" out/swc cr_only.swc
  expect_output "^3 files before MorphIO, NeuroM, navis: 0 failures"
else echo "SKIPPED: no Python with morphio, neurom and navis: SWC-plus files are not read by others"; fi
expect_done
