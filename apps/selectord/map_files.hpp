// The files of a map as they were when it was opened, and whether they still are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <sys/stat.h>

namespace vdna::selectord
{

class MapFiles
{
  public:
    // Notes what is in the directory; open the map afterwards, and then ask whether anything
    // changed meanwhile. `mapped`: hold the files open too, to watch their bytes. Throws Error.
    MapFiles(const std::string &directory, bool mapped);
    MapFiles(MapFiles &&) = default;
    MapFiles(const MapFiles &) = delete;
    MapFiles &operator=(const MapFiles &) = delete;

    // Whether the directory has other files than those that were noted, or others by these names.
    // Cheap, and without an allocation as long as nothing changes.
    bool is_directory_changed();

    // Of mapped files: the path of one that was changed in place; "" if none was. Size and time of
    // modification tell, and, as long as the file has its name, the time of any change: a new mode
    // or a hard link counts too. Where a page was lost, it is the map's path. Cheap: a system call
    // for each file.
    std::string changed_in_place() const;

    // Do not watch a file of which nothing is in use.
    void forget(const std::string &path);

  private:
    class Descriptor
    {
      public:
        explicit Descriptor(int number) : number_(number) {}
        ~Descriptor();
        Descriptor(Descriptor &&other) noexcept : number_(other.number_) { other.number_ = -1; }
        Descriptor &operator=(Descriptor &&other) noexcept;
        int number() const { return number_; }

      private:
        int number_;
    };

    struct File {
        std::string name, path;
        struct stat about; // all zeros if there is none
        Descriptor descriptor;
    };

    static std::vector<File> files_of(const std::string &directory, bool mapped);
    static bool are_same(const std::vector<File> &a, const std::vector<File> &b);
    bool have_their_names() const;

    std::string directory_;
    std::vector<File> files_;
    timespec listed_{}; // when the directory had last been modified before it was listed
    bool is_changed_ = false;
    uint32_t lost_before_; // pages
    bool mapped_;
};

} // namespace vdna::selectord
