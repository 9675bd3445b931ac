// SPDX-License-Identifier: BSD-3-Clause
#include "side_file.hpp"
#include "guard.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace conceg::mesh {
namespace {

int open_unnamed(const std::string &folder) {
#ifdef O_TMPFILE
  const int unnamed = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (unnamed >= 0) return unnamed;
#endif
  const std::string pattern = folder + "/.conceg-mesh-XXXXXX";
  std::vector<char> path(pattern.begin(), pattern.end());
  path.push_back('\0');
  const int fd = mkostemp(path.data(), O_CLOEXEC);
  if (fd >= 0) unlink(path.data());
  return fd;
}

} // namespace

SideFile::SideFile(const std::string &folder) : fd_(open_unnamed(folder)), name_(folder) {
  if (fd_ < 0)
    fail(CONCEG_E_IO, "temporary folder %s: no file can be made there: %s; set TMPDIR to another folder",
         folder.c_str(), std::strerror(errno));
}

SideFile SideFile::named(const std::string &path) {
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) fail(CONCEG_E_IO, "%s: cannot be opened for writing: %s", path.c_str(), std::strerror(errno));
  SideFile file(fd, path);
  if (flock(fd, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK)
    fail(CONCEG_E_IO, "%s: another run is using this file; give each run one of its own", path.c_str());
  return file;
}

SideFile::~SideFile() {
  if (fd_ >= 0) close(fd_);
}

SideFile::SideFile(SideFile &&other) noexcept
    : fd_(std::exchange(other.fd_, -1)), name_(std::move(other.name_)) {}

void SideFile::fail_io(const char *what) const {
  fail(CONCEG_E_IO, "%s: cannot be %s: %s", name_.c_str(), what, std::strerror(errno));
}

void SideFile::write(std::uint64_t at, const void *bytes, std::size_t count) const {
  const char *from = static_cast<const char *>(bytes);
  while (count) {
    const ssize_t done = pwrite(fd_, from, count, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail_io("written");
    from += done, at += static_cast<std::uint64_t>(done), count -= static_cast<std::size_t>(done);
  }
}

void SideFile::read(std::uint64_t at, void *bytes, std::size_t count) const {
  char *to = static_cast<char *>(bytes);
  while (count) {
    const ssize_t done = pread(fd_, to, count, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done == 0) errno = ENODATA;
    if (done <= 0) fail_io("read");
    to += done, at += static_cast<std::uint64_t>(done), count -= static_cast<std::size_t>(done);
  }
}

std::uint64_t SideFile::size() const {
  struct stat info;
  if (fstat(fd_, &info)) fail_io("examined");
  return static_cast<std::uint64_t>(info.st_size);
}

void SideFile::cut(std::uint64_t bytes) const {
  if (ftruncate(fd_, static_cast<off_t>(bytes))) fail_io("cut");
}

Mapping::Mapping(const SideFile &file, std::uint64_t bytes) : bytes_(bytes) {
  if (!bytes) return;
  void *data = mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, file.descriptor(), 0);
  if (data == MAP_FAILED)
    fail(CONCEG_E_NOMEM, "%s: out of address space: %s", file.name().c_str(), std::strerror(errno));
  data_ = static_cast<const std::byte *>(data);
}

void Mapping::clear() {
  if (data_) munmap(const_cast<std::byte *>(data_), bytes_);
  data_ = nullptr;
}

void Mapping::swap(Mapping &other) noexcept {
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
}

void Mapping::forget() const {
  if (data_) madvise(const_cast<std::byte *>(data_), bytes_, MADV_DONTNEED);
}

void need_free_space(const std::string &folder, double bytes, const char *what) {
  struct statvfs info;
  if (statvfs(folder.c_str(), &info)) return; // the write itself will tell
  const double left = double(info.f_bavail) * double(info.f_frsize);
  if (left < bytes)
    fail(CONCEG_E_IO,
         "%s: %s need about %.1f GB there, %.1f GB are free; set TMPDIR to a larger folder or use a larger "
         "h_um",
         folder.c_str(), what, 1e-9 * bytes, 1e-9 * left);
}

} // namespace conceg::mesh
