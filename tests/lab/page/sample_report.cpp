// SPDX-License-Identifier: GPL-3.0-or-later
// sample_report FOLDER [SWEEP.json]: the report of a sweep that was made up, or of one that was not and its pictures.
#include <cstdio>
#include <filesystem>
#include <string>

#include "base/file.h"
#include "base/output_files.h"
#include "lab/page/page.h"
#include "lab/page/read_pictures.h"
#include "lab/page/read_sweep.h"
#include "lab/page/sample_sweep.h"

namespace {

using namespace meshlode;

Result<lab::page::ReportData> read_given(const std::filesystem::path& path) {
  auto file = MappedFile::open(path);
  if (!file) return file.error();
  auto data = lab::page::read_sweep({reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size()});
  if (!data) return data.error();
  if (const Status status = lab::page::read_pictures(*data, path.parent_path()); !status) return status.error();
  return data;
}

Result<lab::page::ReportData> make_up() {
  auto data = lab::page::read_sweep(lab::page::made_up_sweep());
  if (data) data->pictures = lab::page::made_up_pictures();
  return data;
}

}  // namespace

int main(int count, char** words) {
  if (count < 2) return 1;
  const auto data = count > 2 ? read_given(words[2]) : make_up();
  if (!data) {
    std::fprintf(stderr, "%s\n", data.error().message().c_str());
    return 1;
  }
  OutputFiles files;
  const Status status = lab::page::write_report(*data, words[1], files);
  if (!status) std::fprintf(stderr, "%s\n", status.error().message().c_str());
  return status ? 0 : 1;
}
