// SPDX-License-Identifier: BSD-3-Clause
// Named output files that appear whole or not at all, for the stages that write other files than the
// document.
#pragma once

#include "conceg/doc.h"
#include "guard.hpp"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace conceg {

// One file under a hidden name in its own folder, of the form that `conceg clean` knows and locked while it
// has that name; commit() renames it into place, otherwise it is removed.
class OutputFile {
public:
  explicit OutputFile(const std::string &path) : path_(path) {
    const std::size_t slash = path.rfind('/');
    const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
    static std::atomic<unsigned> counter;
    for (int descriptor = -1; !file_;) {
      temporary_ = folder + "/.conceg-" + std::to_string(getpid()) + "-" +
                   std::to_string(1000000 + counter++) + ".tmp";
      descriptor = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor < 0 && errno == EEXIST) continue;
      if (descriptor < 0) refuse(errno);
      if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) { // a sweep was quicker
        close(descriptor);
        continue;
      }
      file_ = fdopen(descriptor, "wb");
      if (file_) break;
      close(descriptor);
      unlink(temporary_.c_str());
      throw std::bad_alloc();
    }
  }
  ~OutputFile() {
    if (!file_) return;
    unlink(temporary_.c_str());
    std::fclose(file_);
  }
  OutputFile(const OutputFile &) = delete;
  OutputFile &operator=(const OutputFile &) = delete;

  void write(const void *bytes, std::size_t count) {
    if (count && std::fwrite(bytes, 1, count, file_) != count) refuse(errno);
  }
  void write(const std::string &text) { write(text.data(), text.size()); }
  // The hidden name, for a library that writes by name.
  const std::string &temporary() const { return temporary_; }
  // The file gets its name while the lock is held.
  void commit() {
    std::FILE *file = file_;
    file_ = nullptr;
    int reason = 0;
    if (std::fflush(file) != 0 || std::rename(temporary_.c_str(), path_.c_str()) != 0) {
      reason = errno;
      unlink(temporary_.c_str());
    }
    if (std::fclose(file) != 0 && !reason) reason = errno;
    if (reason) refuse(reason);
  }

private:
  [[noreturn]] void refuse(int reason) const {
    fail(CONCEG_E_IO, "%s: cannot write: %s", path_.c_str(), std::strerror(reason));
  }
  std::string path_, temporary_;
  std::FILE *file_ = nullptr;
};

// Makes a folder with its parents, checks that files can be written into it, and removes what killed runs
// have left there.
inline void make_folder(const std::string &path) {
  for (std::size_t end = 1; end <= path.size(); end++) {
    if (end != path.size() && path[end] != '/') continue;
    const std::string part = path.substr(0, end);
    if (mkdir(part.c_str(), 0777) != 0 && errno != EEXIST)
      fail(CONCEG_E_IO, "%s: cannot make this folder: %s", part.c_str(), std::strerror(errno));
  }
  struct stat found;
  if (stat(path.c_str(), &found) != 0 || !S_ISDIR(found.st_mode))
    fail(CONCEG_E_IO, "%s: expected a folder to write into, got something else; choose another with dir",
         path.c_str());
  if (access(path.c_str(), W_OK | X_OK) != 0)
    fail(CONCEG_E_IO, "%s: cannot write into this folder: %s", path.c_str(), std::strerror(errno));
  (void)!conceg_clean(nullptr, path.c_str(), 0, nullptr, nullptr);
}

} // namespace conceg
