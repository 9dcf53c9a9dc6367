import java.nio.file.DirectoryStream;
import java.nio.file.Files;
import java.nio.file.Path;
import lcm.lcm.LCMDataOutputStream;
import lcm.lcm.LCMEncodable;
import lcm.spy.LCMTypeDatabase;

/**
 * RoundTrip SAMPLES OUT: decode each sample, encode it again. The types are found as lcm-spy finds
 * them: by the fingerprint of the message, among all classes of the class path.
 */
class RoundTrip {
    static LCMEncodable decode(LCMTypeDatabase types, byte[] bytes) throws Exception {
        long fingerprint = java.nio.ByteBuffer.wrap(bytes).getLong();
        Class<?> type = types.getClassByFingerprint(fingerprint);
        return (LCMEncodable) type.getConstructor(byte[].class).newInstance((Object) bytes);
    }

    public static void main(String[] arguments) throws Exception {
        LCMTypeDatabase types = new LCMTypeDatabase();
        try (DirectoryStream<Path> samples = Files.newDirectoryStream(Path.of(arguments[0]))) {
            for (Path sample : samples) {
                LCMEncodable message = decode(types, Files.readAllBytes(sample));
                String name = message.getClass().getName();
                LCMDataOutputStream bytes = new LCMDataOutputStream();
                message.encode(bytes);
                Files.write(Path.of(arguments[1], name), bytes.toByteArray());
            }
        }
    }
}
