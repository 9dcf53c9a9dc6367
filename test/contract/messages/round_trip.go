// round_trip SAMPLES OUT: decode each sample, encode it again. messages.go has the types.
package main

import (
	"log"
	"os"
	"path/filepath"
)

type message interface {
	Decode(data []byte) error
	Encode() ([]byte, error)
}

func check(err error) {
	if err != nil {
		log.Fatal(err)
	}
}

func main() {
	for name, message := range messages {
		data, err := os.ReadFile(filepath.Join(os.Args[1], name))
		check(err)
		check(message.Decode(data))
		data, err = message.Encode()
		check(err)
		check(os.WriteFile(filepath.Join(os.Args[2], name), data, 0o666))
	}
}
