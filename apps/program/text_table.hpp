// Tables for terminals.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace vdna::program
{

// Cells in columns.
class TextTable
{
  public:
    void begin_row() { rows_.emplace_back(); }
    // marked: the escape sequence before the text, "" for none.
    void add(const std::string &text, const std::string &marked = "")
    {
        const size_t column = rows_.back().size();
        if (column == widths_.size())
            widths_.push_back(0);
        widths_[column] = std::max(widths_[column], text.size());
        rows_.back().push_back({text, marked});
    }

    void add_row(const std::vector<std::string> &cells)
    {
        begin_row();
        for (const std::string &cell : cells)
            add(cell);
    }

    // Left-aligned, two blanks between columns.
    std::string text() const
    {
        std::string text;
        for (const std::vector<Cell> &row : rows_) {
            std::string line;
            for (size_t i = 0; i < row.size(); i++) {
                const std::string blanks(widths_[i] - row[i].text.size() + 2, ' ');
                line += row[i].mark.empty() ? row[i].text : row[i].mark + row[i].text + "\x1b[0m";
                line += i + 1 < row.size() ? blanks : "";
            }
            text += line + "\n";
        }
        return text;
    }

  private:
    struct Cell {
        std::string text, mark;
    };
    std::vector<std::vector<Cell>> rows_;
    std::vector<size_t> widths_;
};

} // namespace vdna::program
