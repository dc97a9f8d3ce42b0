!> Record files: formats, header dialects, units, and the messages for damaged files.
program test_record
   use check, only: checks_t
   use rwmf_core_error, only: err_input, error_t
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_record_record_reader, only: parse_record, read_record
   use rwmf_problem_record, only: record_t
   implicit none

   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: title = 'PEER STRONG MOTION RECORD'//nl//'a place, a day'//nl &
      //'ACCELERATION TIME SERIES IN UNITS OF G'//nl
   character(*), parameter :: numbers = '  .10E-01 -.30E-01'//nl//'0.02,-.005'//nl
   real(wp), parameter :: g = 9.81_wp
   real(wp), parameter :: round_off = 4*epsilon(1.0_wp)
   !! two products in working precision
   type(checks_t) :: checks

   if (checks%wants('one_column')) call test_one_column()
   if (checks%wants('two_columns')) call test_two_columns()
   if (checks%wants('uneven_times')) call test_uneven_times()
   if (checks%wants('units')) call test_units()
   if (checks%wants('at2_dialects')) call test_at2_dialects()
   if (checks%wants('files')) call test_files()
   call checks%finish()

contains

   subroutine test_one_column()
      type(error_t), allocatable :: error
      type(record_t) :: record

      call parse_record('# comment'//nl//'acceleration'//nl//nl//' .5'//achar(13)//nl//'-1d0'//nl &
         //'# another'//nl//'0', 0.5_wp, 'm/s2', 2.0_wp, g, record, error)
      call checks%no_error(error, 'one column')
      if (allocated(error)) return
      call checks%that(record%format == 'one column' .and. record%n == 3, 'one column, 3 samples')
      call checks%close_to(record%factor*record%a(1), 1.0_wp, 'scaled sample')
      call checks%close_to(record%t(3), 1.0_wp, 'sample 1 is at t = 0')
      call checks%close_to(record%peak, 2.0_wp, 'peak')
      call checks%close_to(record%t_peak, 0.5_wp, 'time of the peak')
      call checks%close_to(record%dt, 0.5_wp, 'interval')
   end subroutine test_one_column

   subroutine test_two_columns()
      type(error_t), allocatable :: error
      type(record_t) :: record

      call parse_record('time,acc (g)'//nl//'0,0'//nl//'0.02,0.0063'//nl//'0.04, -0.5,'//nl, &
         unit='g', scale=1.0_wp, g=g, record=record, error=error)
      call checks%no_error(error, 'two columns')
      if (allocated(error)) return
      call checks%that(record%format == 'two columns' .and. record%n == 3, 'two columns')
      call checks%close_to(record%factor*record%a(2), g*real(0.0063_dp, wp), 'unit g', &
         rtol=round_off)
      call checks%that(allocated(record%dt), 'uniform times have an interval')
      call checks%that(record%crc32 == '463e2d82', 'checksum of the bytes', record%crc32)
   end subroutine test_two_columns

   subroutine test_uneven_times()
      type(error_t), allocatable :: error
      type(record_t) :: record

      call parse_record('-1 0'//nl//'0 1'//nl//'5 0', unit='m/s2', scale=1.0_wp, g=g, &
         record=record, error=error)
      call checks%no_error(error, 'uneven times')
      if (allocated(error)) return
      call checks%that(.not. allocated(record%dt), 'uneven times have no interval')
      call checks%close_to(record%t(1), -1.0_wp, 'times are kept')
   end subroutine test_uneven_times

   subroutine test_units()
      type(error_t), allocatable :: error
      type(record_t) :: record

      call parse_record('0'//nl//'100', 1.0_wp, 'cm/s2', -3.0_wp, g, record, error)
      call checks%no_error(error, 'cm/s2')
      if (.not. allocated(error)) then
         call checks%close_to(record%factor*record%a(2), -3.0_wp, 'cm/s2 and a negative scale', &
            rtol=round_off)
      end if
      call parse_record('0'//nl//'1e307', 1.0_wp, 'g', 1000.0_wp, g, record, error)
      call checks%has_error(error, err_input, 'overflow', 'accelerations that overflow')
   end subroutine test_units

   !> The four forms of the line with NPTS and DT.
   subroutine test_at2_dialects()
      character(60), parameter :: headers(4) = [character(60) :: &
         'NPTS=      4, DT=   .0100 SEC,', &
         'NPTS=  4, DT= .01000 SEC, FILTER: 0.2 HZ, 0 POLE @ 3', &
         '   4    0.0100    NPTS, DT', &
         'NPTS =      4 , DT =   .010 SEC ,']
      type(error_t), allocatable :: error
      type(record_t) :: record
      integer :: i

      do i = 1, size(headers)
         call parse_record(title//trim(headers(i))//nl//numbers//'*** End Data ***'//nl//'1 2 3', &
            scale=1.0_wp, g=g, record=record, error=error)
         call checks%no_error(error, trim(headers(i)))
         if (allocated(error)) cycle
         call checks%that(record%format == 'AT2' .and. record%n == 4, 'AT2 has 4 samples')
         call checks%close_to(record%peak, g*real(0.03_dp, wp), 'AT2 is in g', rtol=round_off)
         call checks%close_to(record%dt, real(0.01_dp, wp), 'interval of AT2')
      end do
   end subroutine test_at2_dialects

   subroutine test_files()
      type(error_t), allocatable :: error
      type(record_t) :: record

      call read_record('no such file', scale=1.0_wp, g=g, record=record, error=error)
      call checks%has_error(error, err_input, 'does not exist', 'a file that does not exist')
      call read_record('.', scale=1.0_wp, g=g, record=record, error=error)
      call checks%has_error(error, err_input, 'file', 'a folder')
      call read_record('/dev/zero', scale=1.0_wp, g=g, record=record, error=error)
      call checks%has_error(error, err_input, 'file', 'a device')
   end subroutine test_files

end program test_record
