#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Small files of every format that import reads, each behind the letter that fuzz_import.cpp chooses it by.  import_seeds.sh FOLDER
cd "$1" || exit 1
printf 'A20\n2\n2\n-6 0 0 1\n6 0 0 1\n3\n-6 3 3 0.5 \n0 3 3.5 0.5 \n6 3 3 0.5 \n' > cactus
printf 'A-1\n1\n1\n0 0 0 2\n' > cactus-ball
head='cell_type cell_id component component_id X Y Z inner_radius outer_radius'
printf 'B%s\naxon 0 axon 0 1 2 3 0.4 0.5\naxon 0 axon 0 2 2 3 0.4 0.5\nglial_cell 0 soma 0 9 9 9 2 2\nglial_cell 0 branch 1 11 9 9 0.5 0.5\nblood_vessel 0 blood_vessel 0 5 5 5 1 1\0Voxel Size 20\n' "$head" > caterpillar
printf 'B%s\nglial_cell 0 soma 0 0 9 9 9 2 2\nglial_cell 0 branch 1 0 11 9 9 0.5 0.5\nglial_cell 0 branch 2 1 11 10 9 0.5 0.5\0Small voxel min limits 0 0 0\nSmall voxel max limits 20 20 20\n' \
  'cell_type cell_id component component_id parent_component_id X Y Z inner_radius outer_radius' > caterpillar-c
printf 'Bid_ax id_sph id_branch Type X Y Z Rin Rout P\n0 0 -1 axon 1 2 3 0.5 0.5 -1\n0 1 -1 axon 1 2 4 0.5 0.5 0\n0 0 0 CellSoma 9 9 9 2 2 -1\n0 1 1 Process 11 9 9 0.5 0.5 0\0Voxel 20\n' > caterpillar-a
printf 'C0 0 0 1\n1 0 0 1\n\n5 5 5 1\n6 5 5 1\n\n\n9 9 9 1\n9 9 8 1\n' > fastpli
printf 'D0 0 0\n0 0 0.001\n0 0.001 0.002\n' > nfg
printf 'E{"voxelSize": 20, "axons": [{"gRatio": 0.7, "ellipsoids": [{"position": [1,2,3], "shape": [1,0,0,0,1,0,0,0,1], "myelinDiameter": 1, "axonDiameter": 0.7}, {"position": [2,2,3], "shape": [1,0,0,0,1,0,0,0,1], "myelinDiameter": 1, "axonDiameter": 0.7}]}], "cells": [{"position": [0,0,0], "shape": [1,0,0,0,1,0,0,0,1]}]}' > wmg
tetrahedron='0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n'
printf "Fply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n$tetrahedron" > ply
for order in little big; do
  printf 'Fply\nformat binary_%s_endian 1.0\ncomment x\nelement vertex 3\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list uchar ushort vertex_indices\nend_header\n' $order > ply-$order
  head -c 51 /dev/zero >> ply-$order
done
printf '\003\000\000\001\000\002\000' >> ply-little
printf '\003\000\000\000\001\000\002' >> ply-big
printf 'G# box_um 0 0 0 20 20 20 periodic 1 0 1\n0 3 4 6 0.5\n1 5 4 6 0.25\n\0000 1 0 0 0\n0 1 -1 0 0\n0 0 0 0 1\n' > network
printf 'Hb,signal,standard_error,compartment,direction_x,direction_y,direction_z,pulse_duration_ms,pulse_separation_ms\n0,1,0,all,0,0,1,5,20\n1,0.5,0.01,all,1,0,0,5,20\n0,1,0,intra,0,0,1,5,20\n1,0.7,0.01,intra,1,0,0,5,20\n' > signal
printf 'I\223NUMPY\001\000?\000{\047descr\047: \047<u2\047, \047fortran_order\047: False, \047shape\047: (2, 3, 2), }\012\000\000\002\000\001\000\000\000\002\000\001\000\000\000\002\000\001\000\000\000\002\000\001\000' > labels
printf 'IPK\003\004\024\000\000\000\000\000\000\000\041\000jB{Ga\000\000\000a\000\000\000\012\000\000\000labels.npy\223NUMPY\001\000?\000{\047descr\047: \047<u2\047, \047fortran_order\047: False, \047shape\047: (2, 3, 2), }\012\000\000\002\000\001\000\000\000\002\000\001\000\000\000\002\000\001\000\000\000\002\000\001\000PK\001\002\024\003\024\000\000\000\000\000\000\000\041\000jB{Ga\000\000\000a\000\000\000\012\000\000\000\000\000\000\000\000\000\000\000\200\001\000\000\000\000labels.npyPK\005\006\000\000\000\000\001\000\001\0008\000\000\000\211\000\000\000\000\000' > labels-stored
printf 'IPK\003\004\024\000\000\000\010\000\000\000\041\000jB{GN\000\000\000a\000\000\000\012\000\000\000labels.npy\233\354\027\352\033\020\311\310\140\317P\255\236\222Z\234\134\244n\245\240nSj\244\256\243\240\236\226_TR\224\230\027\237_\224\222\012\022wK\314)N\005\212\027g\044\026\244\002\371\032F:\012\306:\012F\232:\012\265\134\014\014L\014\214\014\230\044\000PK\001\002\024\003\024\000\000\000\010\000\000\000\041\000jB{GN\000\000\000a\000\000\000\012\000\000\000\000\000\000\000\000\000\000\000\200\001\000\000\000\000labels.npyPK\005\006\000\000\000\000\001\000\001\0008\000\000\000v\000\000\000\000\000' > labels-deflated
