/* SPDX-License-Identifier: BSD-3-Clause
 * conceg help TOPIC: parts of spec/, embedded by the build. */
#ifndef CONCEG_APPS_TOPICS_H
#define CONCEG_APPS_TOPICS_H

/* Prints a topic (`detail`: a group of the format, such as /cells, or NULL). -1 when there is no such topic.
 */
int topic_print(const char *name, const char *detail);
/* The error line for a word that is neither a word nor a topic, with the nearest topic. Returns its exit
 * code. */
int topic_unknown(const char *name);

#endif
