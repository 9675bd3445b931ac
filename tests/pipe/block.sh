#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A block of a tissue that is cut out, meshed and simulated alone is what it is in the whole: the same labels voxel by voxel, the same
# vertices; in one process, in a pipe and from a checkpoint the same bytes.  block.sh BIN SOURCE
. "$(dirname -- "$0")/common.sh"
python=${CONCEG_PYTHON:-python3}
"$python" -c 'import h5py, numpy, scipy.spatial' 2>/dev/null || skip "no Python with h5py, numpy and scipy: the block is not compared"
# 27 and 9 um hold whole steps of 0.3 um: the grids of both coincide. Periodic along z too, so that the block sees images of cells.
# Processes are so thick that none breaks, for what is cut off from its soma is left out of the whole.
sed 's/\[28, 28, 28\]/[28, 28, 27]/; s/^mesh: .*/mesh: {h_um: 0.3, tolerance_um: 0}/' "$root/tests/pipe/small.yaml" > tissue.yaml
printf 'place: {min_radius_um: 0.4}\nrelax: {radius_min_um: 0.35}\n' >> tissue.yaml
conceg run tissue.yaml --until mesh -q --checkpoint whole -o whole.cgx || exit 1
conceg run tissue.yaml whole/04-relax.cgx --from block --until mesh --block 9:18 -q -o block.cgx || exit 1
check "the block is valid" conceg validate -q block.cgx
"$python" - > figures <<'COMPARE'
import h5py, numpy as np, scipy.spatial

def read(path):
    with h5py.File(path, "r") as file:
        low, high = file["domain"].attrs["lo"], file["domain"].attrs["hi"]
        shape, spacing = file["volumes"].attrs["shape"], file["volumes"].attrs["spacing"]
        row = np.zeros(shape + 8, int) # + 1; 0 = extracellular
        for origin, leaf in zip(file["volumes/leaf_origin"][:], file["volumes/label"][:]):
            x, y, z = origin
            row[x : x + 8, y : y + 8, z : z + 8] = leaf.reshape(8, 8, 8)
        ids = np.concatenate([[-1], file["cells/id"][:].astype(int)])
        return low, high, spacing, row[: shape[0], : shape[1], : shape[2]], ids, file["meshes/vertex"][:], file["meshes"].attrs["icvf"]

low, high, spacing, row, ids, vertices, _ = read("whole.cgx")
b_low, b_high, b_spacing, b_row, b_ids, b_vertices, icvf = read("block.cgx")
assert np.allclose(spacing, b_spacing)
b_cell = np.where(b_ids < 0, -1, b_ids % 2**40) # pieces of a cell have its id in the low 40 bits
first = round((b_low[2] - low[2]) / spacing[2])
whole, block = ids[row[:, :, first : first + b_row.shape[2]]], b_cell[b_row]

def between_pieces(at):
    """Two pieces of the cell that the whole has here stand within two voxels: cells of their own now, so that a contact plane parts them."""
    near = {b_row[(at[0] + i) % b_row.shape[0], (at[1] + j) % b_row.shape[1], at[2] + k] for i in range(-2, 3) for j in range(-2, 3) for k in range(-2, 3) if 0 <= at[2] + k < b_row.shape[2]}
    return sum(b_cell[r] == whole[tuple(at)] for r in near) >= 2

differ = np.argwhere(whole != block)
parted = [at for at in differ if block[tuple(at)] == -1 and between_pieces(at)]
print("labels that differ", len(differ) - len(parted), "of", block.size, "beside", len(parted), "between two pieces of one cell")
print("planted: one voxel off", (np.roll(whole, 1, 2) != block).sum())
print("filled", round(float((block >= 0).mean()), 4), "icvf of the meshes", round(float(icvf), 4))

side = high - low
wrap = lambda v, axes: np.stack([(v[:, k] - low[k]) % side[k] if k in axes else v[:, k] - low[k] for k in range(3)], 1)
inner = lambda v: v[(v[:, 2] > 9.6) & (v[:, 2] < 17.4)]
a, b = inner(wrap(vertices, (0, 1, 2))), inner(wrap(b_vertices, (0, 1)))
far = lambda a, b: int((scipy.spatial.cKDTree(a).query(b)[0] > 1e-5).sum())
alone = max(far(a, b) / len(b), far(b, a) / len(a))
print("vertices alone: share below 0.005:", alone < 0.005, round(alone, 5), "of", len(b))
print("planted: 0.01 um off, share above 0.9:", far(a + 0.01, b) / len(b) > 0.9)
COMPARE
cat figures
check "some labels were compared" grep -qE 'labels that differ [0-9]+ of [1-9][0-9]{4}' figures
check "every voxel has the label of the whole" grep -q 'labels that differ 0 of' figures
check "one voxel off is seen" grep -qE 'planted: one voxel off [1-9][0-9]{2}' figures
# Where faces came too near they were moved apart, in the order of the cells: that is what may differ.
check "vertices inside are those of the whole, and back" grep -q 'vertices alone: share below 0.005: True' figures
check "0.01 um off is seen" grep -q 'planted: 0.01 um off, share above 0.9: True' figures
# The other ways to the same block.
conceg run tissue.yaml --until mesh --block 9:18 -q -o once.cgx || exit 1
check "in one run" conceg diff --absolute 0 --relative 0 -q once.cgx block.cgx
conceg block whole/04-relax.cgx --lo-um 9 --hi-um 18 -q | conceg mesh -q > piped.cgx
check "in a pipe" cmp piped.cgx block.cgx
# It can be simulated, fitted and measured.
conceg simulate block.cgx --walkers 300 --step-ms 0.01 --margin-um 1 --b 0,1,3,6 --directions 6 --compartment intra -q -o simulated.cgx
check "no walker leaks" sh -c 'conceg dump /walkers simulated.cgx | grep -qE "leaks.* 0$"'
check "fitted" conceg fit simulated.cgx -q -o fitted.cgx
check "measured" conceg analyse block.cgx -q -o analysed.cgx
# Wrong ones.
refused() { # refused CODE TEXT words...
  code=$1 text=$2; shift 2
  got=0; conceg "$@" -o no.cgx > /dev/null 2> error || got=$?
  check "$* ends with $code" test "$got" = "$code"
  check "$* says $text" grep -q -- "$text" error
  check "nothing was written" test ! -e no.cgx
}
refused 2 'expected LO:HI in um along z' run tissue.yaml --block 9
refused 2 'block.hi_um: expected a number' run tissue.yaml --block 9:x
refused 2 '--block mesh: not among the stages' run tissue.yaml --set 'stages=[place]' --block 9:18
refused 3 'along z, got 30 to 40' block whole/04-relax.cgx --lo-um 30 --hi-um 40
done_checking
