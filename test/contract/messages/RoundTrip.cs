using System;
using System.IO;
using LCM.LCM;

// RoundTrip SAMPLES OUT: decode each sample, encode it again.
static class RoundTrip
{
    static void Main(string[] arguments)
    {
        foreach (string sample in Directory.GetFiles(arguments[0]))
        {
            string name = Path.GetFileName(sample);
            object message = Activator.CreateInstance(Type.GetType(name), File.ReadAllBytes(sample));
            var bytes = new LCMDataOutputStream();
            ((LCMEncodable)message).Encode(bytes);
            File.WriteAllBytes(Path.Combine(arguments[1], name), bytes.ToArray());
        }
    }
}
