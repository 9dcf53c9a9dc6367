// How much is waiting in the sockets of another network, so that a sender can wait for its
// receiver.
#ifndef UNREAD_H
#define UNREAD_H

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

// Most bytes in one of the sockets that /proc/PID/net/udp or /proc/PID/net/packet lists.
static inline unsigned long unread_bytes(const char *path)
{
    const bool is_udp = strstr(path, "/udp") != NULL;
    FILE *file = fopen(path, "r");
    char line[512];
    unsigned long most = 0;
    while (file && fgets(line, sizeof line, file)) {
        unsigned long bytes = 0;
        if (is_udp)
            sscanf(line, "%*s %*s %*s %*s %*x:%lx", &bytes);
        else
            sscanf(line, "%*s %*s %*s %*s %*s %*s %lu", &bytes);
        if (bytes > most)
            most = bytes;
    }
    if (file)
        fclose(file);
    return most;
}

// Wait until they have been read, but for that many bytes. Ten seconds at most.
static inline void wait_until_read(const char *path, unsigned long bytes)
{
    for (int tries = 0; tries < 200000 && unread_bytes(path) > bytes; tries++)
        nanosleep(&(struct timespec){.tv_nsec = 50000}, NULL);
}

#endif
