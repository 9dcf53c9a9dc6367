#include <vdna/status.h>

/* see vdna/status.h */
const char *vdna_status_text(vdna_status status)
{
    switch (status) {
    case VDNA_OK:
        return "ok";
    case VDNA_ERR_ARG:
        return "invalid argument";
    case VDNA_ERR_NOMEM:
        return "not enough memory";
    case VDNA_ERR_NONFINITE:
        return "not a finite number";
    case VDNA_ERR_FULL:
        return "count would overflow";
    case VDNA_ERR_EMPTY:
        return "empty";
    case VDNA_ERR_MISMATCH:
        return "not comparable";
    case VDNA_ERR_OVERFLOW:
        return "too many samples for an exact distance";
    case VDNA_ERR_UNDERFLOW:
        return "subtracting what was never added";
    case VDNA_ERR_IO:
        return "refused by the operating system";
    case VDNA_ERR_FORMAT:
        return "malformed data";
    case VDNA_ERR_CHECKSUM:
        return "checksum does not match";
    case VDNA_ERR_UNSUPPORTED:
        return "not supported by this version";
    case VDNA_ERR_RUNTIME:
        return "the network's runtime failed";
    case VDNA_ERR_LATE:
        return "older than a frame before it";
    default:
        return "unknown status";
    }
}
