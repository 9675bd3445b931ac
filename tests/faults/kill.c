/* SPDX-License-Identifier: BSD-3-Clause
 * Kills one program at a random moment and looks at what is left.
 *   kill SEED TIMES AIM FOLDER STAGE OUTPUT COMMAND...
 * COMMAND writes OUTPUT (a file or a folder) inside FOLDER and reports its phases (--progress=json). It is
 * run undisturbed first: its output is what every later run must give. Then TIMES times: a fresh folder of
 * outputs, every second time with an old OUTPUT in place; SIGKILL or SIGINT in turn; the first shot of each
 * kind is aimed into the phase AIM (run, write), the others anywhere. Afterwards: OUTPUT is absent, old, or
 * whole; TMPDIR is empty; at most one unfinished file is beside OUTPUT and none after SIGINT; another run
 * gives the bytes of the undisturbed one and takes the unfinished file away. Prints one line per kill. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { LOG_BYTES = 1 << 16, ATTEMPTS = 40 };

struct run {
  pid_t child;
  int log_fd;
  char log[LOG_BYTES];
  size_t used;
  double began, aim_began, aim_ended; /* seconds; 0 = not seen */
};

static char **command;
static const char *output, *aim;
static uint64_t random_state;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* SplitMix64. */
static double uniform(void) {
  uint64_t x = random_state += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

static void die(const char *what) {
  fprintf(stderr, "kill: %s: %s\n", what, strerror(errno));
  exit(2);
}

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *place) {
  (void)info, (void)kind, (void)place;
  return remove(path);
}
static void remove_all(const char *path) {
  nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

static void start(struct run *run) {
  int ends[2];
  memset(run, 0, sizeof *run);
  if (pipe2(ends, O_CLOEXEC)) die("pipe");
  run->began = now();
  run->child = fork();
  if (run->child < 0) die("fork");
  if (!run->child) {
    dup2(ends[1], STDERR_FILENO);
    execvp(command[0], command);
    _exit(127);
  }
  close(ends[1]);
  run->log_fd = ends[0];
  fcntl(run->log_fd, F_SETFL, O_NONBLOCK);
}

/* Takes in what the program has said; notes when the phase aimed at began and ended. 0 at the end of the log.
 */
static int listen(struct run *run) {
  for (;;) {
    const ssize_t got =
        run->used < LOG_BYTES - 1 ? read(run->log_fd, run->log + run->used, LOG_BYTES - 1 - run->used) : 0;
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    if (got == 0) return 0;
    run->used += (size_t)got;
    run->log[run->used] = '\0';
    char mark[64];
    snprintf(mark, sizeof mark, "\"phase\":\"%s\"", aim);
    const char *at = strstr(run->log, mark);
    if (!run->aim_began && at) run->aim_began = now();
    if (!run->aim_ended && at && strstr(at + 9, "\"phase\":\"")) run->aim_ended = now();
  }
}

/* Waits for news of the log until a moment. 0 when the program has ended. */
static int listen_until(struct run *run, double moment, int until_aim) {
  for (;;) {
    if (!listen(run)) return 0;
    if (until_aim && run->aim_began) return 1;
    const double left = moment - now();
    if (left <= 0) return 1;
    struct pollfd wait = {run->log_fd, POLLIN, 0};
    const struct timespec patience = {(time_t)left, (long)((left - (double)(time_t)left) * 1e9)};
    ppoll(&wait, 1, &patience, NULL);
  }
}

static const char *last_phase(const struct run *run) {
  static char phase[32];
  const char *at = run->log, *found = NULL;
  while ((at = strstr(at, "\"phase\":\"")) != NULL)
    found = at += 9;
  snprintf(phase, sizeof phase, "%.*s", found ? (int)strcspn(found, "\"") : 5, found ? found : "start");
  return phase;
}

static int finish(struct run *run) {
  int state;
  while (listen(run)) {
    struct pollfd wait = {run->log_fd, POLLIN, 0};
    poll(&wait, 1, 1000);
  }
  if (waitpid(run->child, &state, 0) < 0) die("waitpid");
  close(run->log_fd);
  return state;
}

static int fail(const struct run *run, const char *what) {
  printf("FAILED: %s\n%s\n", what, run->log);
  return 1;
}

/* Unfinished files below a folder; `name` receives one. */
static unsigned count_partial(const char *folder, char *name, size_t size) {
  unsigned count = 0;
  DIR *list = opendir(folder);
  if (!list) return 0;
  for (struct dirent *item; (item = readdir(list)) != NULL;) {
    char path[4096];
    struct stat info;
    if (!strcmp(item->d_name, ".") || !strcmp(item->d_name, "..")) continue;
    snprintf(path, sizeof path, "%s/%s", folder, item->d_name);
    if (!lstat(path, &info) && S_ISDIR(info.st_mode)) count += count_partial(path, name, size);
    if (!strncmp(item->d_name, ".conceg-", 8)) count++, snprintf(name, size, "%s", path);
  }
  closedir(list);
  return count;
}

static unsigned count_entries(const char *folder) {
  unsigned count = 0;
  DIR *list = opendir(folder);
  if (!list) return 0;
  while (readdir(list))
    count++;
  closedir(list);
  return count - 2;
}

/* Every file below `got` is there in `wanted` with the same bytes; with `all`, the other way round too. */
static int is_part_of(const char *got, const char *wanted, int all) {
  char line[12800];
  struct stat info;
  if (lstat(got, &info)) return !all;
  snprintf(line, sizeof line, "diff -rq '%s' '%s' | grep -v '^Only in .*: \\.conceg-' %s%s%s | grep -q .",
           got, wanted, all ? "" : "| grep -v '^Only in ", all ? "" : wanted, all ? "" : "'");
  return system(line) != 0;
}

static void copy(const char *from, const char *to) {
  char line[8300];
  snprintf(line, sizeof line, "cp -r '%s' '%s'", from, to);
  if (system(line)) die(line);
}

struct setting {
  const char *stage, *old, *wanted, *folder, *tmp, *input;
  double aim_seconds, all_seconds;
  unsigned in_aim;
};

static int check_after(const struct run *run, const struct setting *at, int number, int had_old) {
  char name[4096] = "";
  struct stat info;
  const unsigned partial = count_partial(at->folder, name, sizeof name);
  const int there = !lstat(output, &info);
  if (count_entries(at->tmp)) return fail(run, "something is left in TMPDIR");
  if (partial > (number == SIGKILL ? 1u : 0u))
    return fail(run, "more unfinished files beside the output than one after SIGKILL, none after SIGINT");
  if (had_old && !there) return fail(run, "the old output is gone");
  if (there && !is_part_of(output, at->wanted, 0) && !(had_old && is_part_of(output, at->old, 0)))
    return fail(run, "the output is torn");
  return 0;
}

static int check_rerun(const struct setting *at) {
  static struct run again;
  char name[4096];
  start(&again);
  const int state = finish(&again);
  if (!WIFEXITED(state) || WEXITSTATUS(state)) return fail(&again, "the next run failed");
  if (!is_part_of(output, at->wanted, 1)) return fail(&again, "the next run gave other bytes");
  if (count_partial(at->folder, name, sizeof name))
    return fail(&again, "the next run left the unfinished file there");
  return 0;
}

/* One kill. Returns 0, 1 = a check failed, -1 = the program was done before. */
static int shoot(struct setting *at, int number, int aimed, int with_old, double shorten) {
  static struct run run;
  const double share = uniform();
  remove_all(output);
  if (with_old) copy(at->old, output);
  start(&run);
  int alive;
  if (aimed) {
    alive = listen_until(&run, run.began + 600, 1);
    if (alive) alive = listen_until(&run, now() + shorten * share * at->aim_seconds, 0);
  } else {
    alive = listen_until(&run, run.began + share * at->all_seconds, 0);
  }
  if (alive) kill(run.child, number);
  if (number == SIGINT) listen(&run);
  char phase[32];
  snprintf(phase, sizeof phase, "%s", last_phase(&run));
  const int state = finish(&run);
  if (number == SIGKILL) snprintf(phase, sizeof phase, "%s", last_phase(&run));
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return -1;
  if (WIFEXITED(state) && (number == SIGKILL || WEXITSTATUS(state) != 6))
    return fail(&run, "expected the signal, or exit code 6 after SIGINT");
  if (WIFSIGNALED(state) && WTERMSIG(state) != number) return fail(&run, "another signal ended it");
  const int in_aim = !strcmp(phase, aim);
  at->in_aim += (unsigned)in_aim;
  char name[4096] = "";
  printf("%-12s %-7s after %7.1f ms in phase %-8s %s; %s\n", at->stage,
         number == SIGKILL ? "SIGKILL" : "SIGINT", 1e3 * (now() - run.began), phase,
         with_old ? "over an old output" : "with no old output",
         count_partial(at->folder, name, sizeof name) ? "1 unfinished file, taken away by the next run"
                                                      : "nothing left");
  if (check_after(&run, at, number, with_old)) return 1;
  return check_rerun(at);
}

int main(int argc, char **argv) {
  static struct run calm;
  if (argc < 8) return 2;
  const int times = atoi(argv[2]);
  struct setting at = {.stage = argv[5], .folder = argv[4]};
  char wanted[4096], old[4096], tmp[4096];
  aim = argv[3], output = argv[6], command = argv + 7;
  random_state = strtoull(argv[1], NULL, 10);
  for (const char *c = at.stage; *c; c++)
    random_state = random_state * 31 + (unsigned char)*c;
  snprintf(wanted, sizeof wanted, "%s.wanted", at.folder);
  snprintf(old, sizeof old, "%s.old", at.folder);
  snprintf(tmp, sizeof tmp, "%s.tmp", at.folder);
  at.wanted = wanted, at.old = old, at.tmp = tmp;
  if (mkdir(tmp, 0777) && errno != EEXIST) die(tmp);
  setenv("TMPDIR", tmp, 1);

  /* The second run is the one that is timed: the first fills the caches. */
  for (int k = 0; k < 2; k++) {
    remove_all(output);
    start(&calm);
    const int state = finish(&calm);
    if (!WIFEXITED(state) || WEXITSTATUS(state)) return fail(&calm, "the undisturbed run failed");
  }
  if (!calm.aim_began) return fail(&calm, "the undisturbed run did not tell of the phase aimed at");
  at.all_seconds = now() - calm.began;
  at.aim_seconds = (calm.aim_ended ? calm.aim_ended : now()) - calm.aim_began;
  copy(output, wanted);
  struct stat info;
  if (!stat(output, &info) && S_ISDIR(info.st_mode))
    copy(output, old);
  else if (!freopen(old, "w", stdin) || write(STDIN_FILENO, "old\n", 4) != 4)
    die(old);

  for (int k = 0; k < times; k++) {
    const int number = k % 2 ? SIGINT : SIGKILL, aimed = k < 2, with_old = k / 2 % 2;
    double shorten = 1;
    int result = -1;
    for (int attempt = 0; attempt < ATTEMPTS && result < 0; attempt++, shorten *= 0.8)
      result = shoot(&at, number, aimed, with_old, shorten);
    if (result > 0) return 1;
    if (result < 0) printf("%s: no shot met the program\n", at.stage);
  }
  printf("%s: %d kills, %u of them inside %s%s, which takes %.1f of %.1f ms\n", at.stage, times, at.in_aim,
         aim, strcmp(aim, "run") ? "" : "()", 1e3 * at.aim_seconds, 1e3 * at.all_seconds);
  if (!at.in_aim) printf("FAILED: no kill inside the phase %s\n", aim);
  return !at.in_aim;
}
