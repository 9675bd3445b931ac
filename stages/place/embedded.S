/* SPDX-License-Identifier: BSD-3-Clause
 * The default dictionary, byte for byte, inside the program. */
  .section .rodata
  .global conceg_default_dictionary
  .global conceg_default_dictionary_end
  .hidden conceg_default_dictionary
  .hidden conceg_default_dictionary_end
  .balign 16
conceg_default_dictionary:
  .incbin CONCEG_DICTIONARY_FILE
conceg_default_dictionary_end:
  .byte 0
  .section .note.GNU-stack,"",%progbits
