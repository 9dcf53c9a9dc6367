using System;
using System.IO;

// What generated code needs of LCM's library for C#, which Debian has not.
namespace LCM.LCM
{
    public interface LCMEncodable
    {
        void Encode(LCMDataOutputStream outs);
    }

    public class LCMDataOutputStream
    {
        private readonly MemoryStream stream = new MemoryStream();

        public byte[] ToArray() { return stream.ToArray(); }
        public void Write(byte[] bytes, int from, int count) { stream.Write(bytes, from, count); }
        public void Write(byte value) { stream.WriteByte(value); }
        public void Write(bool value) { stream.WriteByte((byte)(value ? 1 : 0)); }
        public void Write(int value) { WriteReversed(BitConverter.GetBytes(value)); }
        public void Write(long value) { WriteReversed(BitConverter.GetBytes(value)); }
        public void Write(double value) { WriteReversed(BitConverter.GetBytes(value)); }

        private void WriteReversed(byte[] bytes)
        {
            Array.Reverse(bytes);
            stream.Write(bytes, 0, bytes.Length);
        }
    }

    public class LCMDataInputStream
    {
        private readonly byte[] bytes;
        private int at;

        public LCMDataInputStream(byte[] bytes) { this.bytes = bytes; }
        public byte ReadByte() { return bytes[at++]; }
        public bool ReadBoolean() { return bytes[at++] != 0; }
        public int ReadInt32() { return BitConverter.ToInt32(Reversed(4), 0); }
        public long ReadInt64() { return BitConverter.ToInt64(Reversed(8), 0); }
        public double ReadDouble() { return BitConverter.ToDouble(Reversed(8), 0); }

        public void ReadFully(byte[] buffer)
        {
            Array.Copy(bytes, at, buffer, 0, buffer.Length);
            at += buffer.Length;
        }

        private byte[] Reversed(int count)
        {
            byte[] part = new byte[count];
            Array.Copy(bytes, at, part, 0, count);
            Array.Reverse(part);
            at += count;
            return part;
        }
    }
}
