// ONNX files: only the very bytes that were pinned are loaded, and they are never held here.
#pragma once

#include <filesystem>
#include <string>

#include "open_file.hpp"

namespace vdna::backbone
{

class Model
{
  public:
    // A model whose SHA-256 is `sha256` and which needs no other file; it stays open.
    // Throws Failure (VDNA_ERR_IO, VDNA_ERR_CHECKSUM, VDNA_ERR_UNSUPPORTED).
    Model(const std::filesystem::path &file, const std::string &sha256);

    const std::filesystem::path &name() const { return file_.name(); }

    // Where to load it from: the open file itself, whatever has its name by now.
    // Throws Failure (VDNA_ERR_IO).
    std::string path() const;

    // After loading. Throws Failure (VDNA_ERR_IO) if that may not be what was hashed.
    void require_unchanged() const { file_.require_unchanged(); }

  private:
    OpenFile file_;
};

} // namespace vdna::backbone
