/* By make_pillow.py with Pillow 12.0.0: hashes of resized noise. */
static const struct {
    int width, height, to_width, to_height, channels;
    uint64_t fnv1a;
} pillow_golden[] = {
    {640, 480, 224, 224, 3, 0xcf9ce64d3c881648},  {480, 640, 224, 224, 1, 0xe86e960f91ce26f9},
    {1280, 720, 224, 224, 3, 0x3044da053d4eff6a}, {512, 192, 224, 224, 3, 0x2eaf35f261754bcb},
    {320, 240, 256, 320, 3, 0x55a32ad4733ec6d3},  {100, 75, 224, 224, 3, 0x37b5a5f206d4ad30},
    {224, 300, 224, 224, 3, 0x1bbf891cc56ec9e2},  {300, 224, 224, 224, 1, 0x93ac37063e832671},
    {224, 224, 224, 224, 3, 0x4626d05e9d508cad},  {33, 57, 8, 9, 3, 0xddaa6d6f6ece808c},
    {8, 9, 33, 57, 3, 0xb8792fa4830418ec},        {7, 5, 1, 1, 3, 0x69aa0b194f5dde4e},
    {1, 1, 5, 7, 3, 0xa9db9012dee5f4d8},          {2, 640, 3, 480, 1, 0x0b37fb27eecc9488},
};
