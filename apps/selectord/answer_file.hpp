// The file of --answers: one JSON object per line.
#pragma once

#include <string>

namespace vdna::selectord
{

class AnswerFile
{
  public:
    // Empties an earlier file of answers. Throws Error if it cannot be written, or if it holds
    // anything else.
    explicit AnswerFile(const std::string &path);
    ~AnswerFile();
    AnswerFile(const AnswerFile &) = delete;
    AnswerFile &operator=(const AnswerFile &) = delete;

    // Append a line, which readers see whole. Throws Error, for example if the disk is full.
    void write(std::string line);

  private:
    [[noreturn]] void give_up(const char *what) const;

    std::string path_;
    int file_;
};

} // namespace vdna::selectord
