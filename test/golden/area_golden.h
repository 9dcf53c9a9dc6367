/* Hashes of resized noise from the code before lib/picture (OpenCV 4.6 if ratios are whole or a
 * side grows): existing maps were made with these bytes. Of four channels the first three count.
 */
static const struct {
    int width, height, to_width, to_height, channels;
    uint64_t fnv1a;
} area_golden[] = {
    {640, 480, 224, 224, 3, 0xfe949e27e3bd7933},   {640, 480, 224, 224, 1, 0x356f29e5c8fe25c6},
    {640, 480, 224, 224, 4, 0x0643ebb4f8588640},   {1920, 1080, 224, 224, 3, 0xdeb4e8afd7c3b87c},
    {1280, 720, 224, 224, 3, 0x57ed7107e07a8742},  {448, 448, 224, 224, 3, 0x53efe9ba81f503e2},
    {448, 448, 224, 224, 4, 0x20acfb92404fe079},   {672, 896, 224, 224, 3, 0x359f0cb0bfe2ef92},
    {512, 192, 224, 192, 3, 0x75c3a49a5c80ab0c},   {640, 100, 224, 224, 3, 0x21801e5ca4a36a92},
    {100, 75, 224, 224, 3, 0xfd8dbb644eaebf6e},    {225, 224, 224, 224, 3, 0x6b43800b0e4810da},
    {1920, 1080, 640, 480, 3, 0x6bc5b08d85fb26da}, {7, 5, 1, 1, 3, 0x69b115194f640dfa},
    {33, 57, 8, 9, 3, 0x2e21e62fb4145d99},         {1, 1, 5, 7, 3, 0xa9db9012dee5f4d8},
    {2, 640, 3, 480, 1, 0x0e6a7e02799e7da6},       {901, 301, 300, 100, 3, 0xc1d6f93e3e553762},
};
