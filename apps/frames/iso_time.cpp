#include "frames/iso_time.hpp"

#include <cstdio>

#include <time.h>

namespace vdna::frames
{

namespace
{

constexpr int64_t second_us = 1000000;
constexpr int64_t day_s = 86400;
// int64_t microseconds end in the year 292277; stay well within.
constexpr int first_year = 1, last_year = 9999;

bool is_leap(int64_t year)
{
    return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
}

int days_in_month(int64_t year, int month)
{
    static const int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    return days[month - 1] + (month == 2 && is_leap(year) ? 1 : 0);
}

// Days from 1970 to a day of the Gregorian calendar. Years begin in March here, so that a leap day
// is the last one: https://howardhinnant.github.io/date_algorithms.html
int64_t days_of(int64_t year, int month, int day)
{
    year -= month <= 2 ? 1 : 0;
    const int64_t era = (year >= 0 ? year : year - 399) / 400;
    const int64_t of_era = year - era * 400;
    const int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

// Reads a text from its beginning.
class Scanner
{
  public:
    explicit Scanner(const std::string &text) : text_(text) {}

    bool at_end() const { return at_ == text_.size(); }

    bool take(char wanted)
    {
        if (at_end() || text_[at_] != wanted)
            return false;
        at_++;
        return true;
    }

    // Exactly `digits` digits, a number within lo..hi.
    bool number(size_t digits, int lo, int hi, int &out_number)
    {
        int number = 0;
        for (size_t i = 0; i < digits; i++) {
            if (at_end() || text_[at_] < '0' || text_[at_] > '9')
                return false;
            number = 10 * number + (text_[at_++] - '0');
        }
        out_number = number;
        return number >= lo && number <= hi;
    }

    // ".5" or ",5", in microseconds; 0 if there is none.
    bool fraction(int64_t &out_us)
    {
        out_us = 0;
        if (!take('.') && !take(','))
            return true;
        int64_t weight = second_us;
        const size_t begin = at_;
        for (; !at_end() && text_[at_] >= '0' && text_[at_] <= '9'; at_++)
            out_us += (text_[at_] - '0') * (weight /= 10);
        return at_ > begin;
    }

    // "Z", "+02:00", "+0200", "+02" or nothing, in seconds to subtract.
    bool zone(int64_t &out_s)
    {
        out_s = 0;
        if (at_end() || take('Z') || take('z'))
            return true;
        const int sign = take('+') ? 1 : take('-') ? -1 : 0;
        int hours = 0, minutes = 0;
        if (sign == 0 || !number(2, 0, 23, hours))
            return false;
        if (!at_end() && (take(':'), !number(2, 0, 59, minutes)))
            return false;
        out_s = sign * (int64_t{hours} * 3600 + int64_t{minutes} * 60);
        return true;
    }

  private:
    const std::string &text_;
    size_t at_ = 0;
};

} // namespace

std::optional<int64_t> utime_of_iso(const std::string &text)
{
    Scanner scan(text);
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
    if (!scan.number(4, first_year, last_year, year) || !scan.take('-') ||
        !scan.number(2, 1, 12, month) || !scan.take('-') ||
        !scan.number(2, 1, days_in_month(year, month), day) || !(scan.take('T') || scan.take(' ')))
        return {};
    int64_t fraction_us = 0, zone_s = 0;
    if (!scan.number(2, 0, 23, hour) || !scan.take(':') || !scan.number(2, 0, 59, minute) ||
        !scan.take(':') || !scan.number(2, 0, 60, second) || !scan.fraction(fraction_us) ||
        !scan.zone(zone_s) || !scan.at_end())
        return {};
    const int64_t seconds = days_of(year, month, day) * day_s + int64_t{hour} * 3600 +
                            int64_t{minute} * 60 + second - zone_s;
    return seconds * second_us + fraction_us;
}

std::string iso_of(int64_t utime)
{
    int64_t seconds = utime / second_us, fraction_us = utime % second_us;
    if (fraction_us < 0) {
        seconds--;
        fraction_us += second_us;
    }
    const auto whole = static_cast<time_t>(seconds);
    tm calendar{};
    char text[64] = "";
    if (gmtime_r(&whole, &calendar))
        strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &calendar);
    char fraction[16];
    std::snprintf(fraction, sizeof fraction, ".%03dZ", static_cast<int>(fraction_us / 1000));
    return std::string(text) + fraction;
}

std::string date_of(int64_t utime)
{
    constexpr int64_t least = 100'000'000'000'000, most = 1000 * least; // as vdna_time_unit()
    return utime >= least && utime < most ? iso_of(utime) : "";
}

} // namespace vdna::frames
