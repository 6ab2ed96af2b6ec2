// Answers of endpoint 0 and the descriptors, as a host reads them.

#include "firmware/core/usb_control.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace slamd {
namespace {

using Stage = ControlReply::Stage;
using Effect = ControlReply::Effect;
using Bytes = std::vector<std::uint8_t>;

class UsbControlTest : public testing::Test {
 protected:
  UsbControl usb_{UniqueId{0xE6, 0x61, 0x0C, 0x0B, 0x2A, 0x00, 0xFF, 0x9D}};

  ControlReply ask(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
                   std::uint16_t length = 0) {
    return usb_.setup({type, request, value, index, length});
  }
  Bytes get(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index, std::uint16_t length) {
    const ControlReply reply = ask(type, request, value, index, length);
    EXPECT_EQ(reply.stage, Stage::kSend);
    return {reply.bytes.begin(), reply.bytes.end()};
  }
  Bytes descriptor(std::uint16_t value, std::uint16_t length = 255) { return get(0x80, 6, value, 0, length); }
  std::string text(std::uint8_t index) {
    const Bytes bytes = descriptor(static_cast<std::uint16_t>(0x0300U | index));
    EXPECT_EQ(bytes[0], bytes.size());
    EXPECT_EQ(bytes[1], 3);
    std::string text;
    for (std::size_t i = 2; i < bytes.size(); i += 2) {
      EXPECT_EQ(bytes[i + 1], 0);
      text += static_cast<char>(bytes[i]);
    }
    return text;
  }
  void configure() { EXPECT_EQ(ask(0x00, 9, 1, 0).effect, Effect::kConfigure); }
  void set_baud(std::uint32_t baud) {
    ASSERT_EQ(ask(0x21, 0x20, 0, 0, 7).stage, Stage::kReceive);
    const Bytes coding{static_cast<std::uint8_t>(baud),
                       static_cast<std::uint8_t>(baud >> 8U),
                       static_cast<std::uint8_t>(baud >> 16U),
                       0,
                       0,
                       0,
                       8};
    ASSERT_TRUE(usb_.received(coding));
  }
  void set_line_state(std::uint16_t state) { ASSERT_EQ(ask(0x21, 0x22, state, 0).stage, Stage::kAcknowledge); }
};

TEST_F(UsbControlTest, DeviceDescriptorNamesTheBoard) {
  const Bytes device = descriptor(0x0100);
  ASSERT_EQ(device.size(), 18U);
  EXPECT_EQ(device[0], 18);
  EXPECT_EQ(device[1], 1);
  EXPECT_EQ(device[7], 64);
  EXPECT_EQ(device[8] | device[9] << 8, 0x1209);
  EXPECT_EQ(device[10] | device[11] << 8, 0x0001);
  EXPECT_EQ(device[12] | device[13] << 8, 0x0010) << "release 0.1.0";
  EXPECT_EQ(text(device[14]), "slamd");
  EXPECT_EQ(text(device[15]), "slamd IMU");
  EXPECT_EQ(text(device[16]), "E6610C0B2A00FF9D");
}

TEST_F(UsbControlTest, LengthsInTheConfigurationAddUpAndEndpointsMatch) {
  const Bytes configuration = descriptor(0x0200);
  ASSERT_GE(configuration.size(), 9U);
  EXPECT_EQ(static_cast<std::size_t>(configuration[2] | configuration[3] << 8), configuration.size());
  std::size_t interfaces = 0;
  std::size_t promised = 0;
  Bytes endpoints;
  std::size_t at = 0;
  for (; at < configuration.size(); at += configuration[at]) {
    ASSERT_GT(configuration[at], 1);
    if (configuration[at + 1] == 4) {
      EXPECT_EQ(configuration[at + 2], interfaces++);
      promised += configuration[at + 4];
    }
    if (configuration[at + 1] == 5) endpoints.push_back(configuration[at + 2]);
  }
  EXPECT_EQ(at, configuration.size());
  EXPECT_EQ(configuration[4], interfaces);
  EXPECT_EQ(interfaces, 3U);
  EXPECT_EQ(promised, endpoints.size());
  EXPECT_EQ(endpoints, (Bytes{0x81, 0x02, 0x82}));
}

TEST_F(UsbControlTest, TheResetInterfaceIsTheOneThatPicotoolKnows) {
  const Bytes c = descriptor(0x0200);
  const Bytes last(c.end() - 9, c.end());
  EXPECT_EQ(last, (Bytes{9, 4, 2, 0, 0, 0xFF, 0x00, 0x01, 5}));
}

TEST_F(UsbControlTest, NeverMoreThanTheHostAskedFor) {
  EXPECT_EQ(descriptor(0x0200, 9).size(), 9U);
  EXPECT_EQ(descriptor(0x0100, 8).size(), 8U);
  EXPECT_EQ(descriptor(0x0302, 2).size(), 2U);
}

TEST_F(UsbControlTest, WhatDoesNotExistIsStalled) {
  EXPECT_EQ(ask(0x80, 6, 0x0600, 0, 10).stage, Stage::kStall) << "qualifier of a full-speed device";
  EXPECT_EQ(ask(0x80, 6, 0x0306, 0, 255).stage, Stage::kStall);
  EXPECT_EQ(ask(0x80, 6, 0x0101, 0, 255).stage, Stage::kStall);
  EXPECT_EQ(ask(0x00, 9, 2, 0).stage, Stage::kStall) << "second configuration";
  EXPECT_EQ(ask(0x00, 5, 128, 0).stage, Stage::kStall) << "address";
  EXPECT_EQ(ask(0x40, 1, 0, 2).stage, Stage::kStall) << "vendor request";
  EXPECT_EQ(ask(0x00, 3, 1, 0).stage, Stage::kStall) << "remote wake-up";
  configure();
  EXPECT_EQ(ask(0x01, 11, 1, 0).stage, Stage::kStall) << "alternate setting";
  EXPECT_EQ(ask(0x01, 11, 0, 3).stage, Stage::kStall) << "interface";
  EXPECT_EQ(ask(0x02, 1, 0, 0x83).stage, Stage::kStall) << "endpoint";
  EXPECT_EQ(ask(0x21, 0x99, 0, 0).stage, Stage::kStall);
  EXPECT_EQ(ask(0x21, 0x22, 1, 1).stage, Stage::kStall) << "line state of the data interface";
  EXPECT_EQ(ask(0x21, 0x20, 0, 0, 6).stage, Stage::kStall) << "short line coding";
}

TEST_F(UsbControlTest, AddressAndConfigurationTakeEffect) {
  const ControlReply address = ask(0x00, 5, 42, 0);
  EXPECT_EQ(address.stage, Stage::kAcknowledge);
  EXPECT_EQ(address.effect, Effect::kAddress);
  EXPECT_EQ(address.argument, 42);
  EXPECT_EQ(get(0x80, 8, 0, 0, 1), Bytes{0});
  configure();
  EXPECT_TRUE(usb_.configured());
  EXPECT_EQ(get(0x80, 8, 0, 0, 1), Bytes{1});
  EXPECT_EQ(ask(0x00, 9, 0, 0).effect, Effect::kDeconfigure);
  EXPECT_FALSE(usb_.configured());
}

TEST_F(UsbControlTest, HaltIsKeptToldAndCleared) {
  configure();
  EXPECT_EQ(get(0x82, 0, 0, 0x82, 2), (Bytes{0, 0}));
  const ControlReply halt = ask(0x02, 3, 0, 0x82);
  EXPECT_EQ(halt.effect, Effect::kHalt);
  EXPECT_EQ(halt.argument, 0x82);
  EXPECT_EQ(get(0x82, 0, 0, 0x82, 2), (Bytes{1, 0}));
  EXPECT_EQ(get(0x82, 0, 0, 0x02, 2), (Bytes{0, 0}));
  EXPECT_EQ(ask(0x02, 1, 0, 0x82).effect, Effect::kUnhalt);
  EXPECT_EQ(get(0x82, 0, 0, 0x82, 2), (Bytes{0, 0}));
}

TEST_F(UsbControlTest, ClassRequestsNeedAConfiguration) {
  EXPECT_EQ(ask(0x21, 0x22, 1, 0).stage, Stage::kStall);
  EXPECT_EQ(ask(0x21, 1, 0, 2).stage, Stage::kStall);
  EXPECT_EQ(usb_.take_start_request(), StartRequest::kNone);
}

TEST_F(UsbControlTest, ThePortIsOpenWhileTheTerminalIsReady) {
  configure();
  EXPECT_FALSE(usb_.open());
  set_line_state(3);
  EXPECT_TRUE(usb_.open());
  set_line_state(2);
  EXPECT_FALSE(usb_.open());
  set_line_state(1);
  usb_.bus_reset();
  EXPECT_FALSE(usb_.open());
  EXPECT_FALSE(usb_.configured());
}

TEST_F(UsbControlTest, LineCodingComesBack) {
  configure();
  EXPECT_EQ(get(0xA1, 0x21, 0, 0, 7), (Bytes{0x00, 0xC2, 0x01, 0x00, 0, 0, 8}));
  set_baud(9600);
  EXPECT_EQ(get(0xA1, 0x21, 0, 0, 7), (Bytes{0x80, 0x25, 0x00, 0x00, 0, 0, 8}));
}

TEST_F(UsbControlTest, TouchOf1200BaudAsksForTheBootLoaderWhenThePortIsClosed) {
  configure();
  set_baud(1200);
  set_line_state(1);
  EXPECT_EQ(usb_.take_start_request(), StartRequest::kNone);
  set_line_state(0);
  EXPECT_EQ(usb_.take_start_request(), StartRequest::kBootLoader);
  EXPECT_EQ(usb_.take_start_request(), StartRequest::kNone) << "once";
}

TEST_F(UsbControlTest, OtherRatesCloseWithoutConsequence) {
  configure();
  for (const std::uint32_t baud : {9600U, 115200U, 1201U, 1200U << 8U}) {
    set_baud(baud);
    set_line_state(1);
    set_line_state(0);
    EXPECT_EQ(usb_.take_start_request(), StartRequest::kNone) << baud;
  }
}

TEST_F(UsbControlTest, ResetInterfaceStartsProgramOrBootLoader) {
  configure();
  EXPECT_EQ(ask(0x21, 1, 0, 2).stage, Stage::kAcknowledge);
  EXPECT_EQ(usb_.take_start_request(), StartRequest::kBootLoader);
  EXPECT_EQ(ask(0x21, 2, 0, 2).stage, Stage::kAcknowledge);
  EXPECT_EQ(usb_.take_start_request(), StartRequest::kReset);
  EXPECT_EQ(ask(0x21, 3, 0, 2).stage, Stage::kStall);
  EXPECT_EQ(usb_.take_start_request(), StartRequest::kNone);
}

TEST_F(UsbControlTest, NoSetupPacketWhateverItHoldsGetsMoreThanItAskedFor) {
  for (std::uint32_t i = 0; i < 300'000; ++i) {
    const std::uint32_t x = i * 2'654'435'761U;
    const SetupPacket packet{static_cast<std::uint8_t>(x >> 8U), static_cast<std::uint8_t>((x >> 16U) % 40),
                             static_cast<std::uint16_t>((x >> 3U) % 0x0710), static_cast<std::uint16_t>((x >> 20U) % 5),
                             static_cast<std::uint16_t>(x % 300)};
    const ControlReply reply = usb_.setup(packet);
    ASSERT_LE(reply.bytes.size(), packet.length);
    if (reply.stage == Stage::kSend) {
      ASSERT_TRUE((packet.type & 0x80U) != 0);
    }
    if (reply.stage == Stage::kReceive) {
      ASSERT_EQ(packet.length, 7);
    }
  }
}

TEST(SetupPacket, IsReadFromItsEightBytes) {
  const std::array<std::uint8_t, 8> bytes{0xA1, 0x21, 0x34, 0x12, 0x78, 0x56, 0x07, 0x01};
  const SetupPacket packet = SetupPacket::from(bytes);
  EXPECT_EQ(packet.type, 0xA1);
  EXPECT_EQ(packet.request, 0x21);
  EXPECT_EQ(packet.value, 0x1234);
  EXPECT_EQ(packet.index, 0x5678);
  EXPECT_EQ(packet.length, 0x0107);
}

}  // namespace
}  // namespace slamd
