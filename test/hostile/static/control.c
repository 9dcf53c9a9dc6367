/* What clang-tidy must find, so that no finding elsewhere means something. */
int vdna_static_control(void);

int vdna_static_control(void)
{
    const int *nothing = 0;
    return *nothing;
}
