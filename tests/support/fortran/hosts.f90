!> Steps of a host program that drives a wall, for several test programs.
module hosts
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_embedding_stepping, only: advance_stepping, create_stepping, destroy_stepping, &
      query_forces, query_state, restore_stepping, save_stepping, snapshot_t, stepping_t, &
      wall_forces_t, wall_state_t
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: repeats_the_bits

contains

   !> Return whether rotation and forces agree bit by bit when a host takes each step twice, from
   !> the same snapshot.
   logical function repeats_the_bits(case, dt, steps)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: dt
      !! [s]
      integer, intent(in) :: steps
      type(stepping_t) :: wall
      type(snapshot_t) :: snapshot
      type(wall_state_t) :: state(2)
      type(wall_forces_t) :: forces(2)
      type(error_t), allocatable :: error
      integer :: i
      integer :: attempt

      call create_stepping(wall, case, error)
      do i = 1, steps
         do attempt = 1, 2
            if (.not. allocated(error)) then
               if (attempt == 1) call save_stepping(wall, snapshot, error)
               if (attempt == 2) call restore_stepping(wall, snapshot, error)
            end if
            if (.not. allocated(error)) call advance_stepping(wall, i*dt, error)
            if (.not. allocated(error)) call query_state(wall, state(attempt), error)
            if (.not. allocated(error)) call query_forces(wall, forces(attempt), error)
         end do
         repeats_the_bits = .not. allocated(error)
         if (repeats_the_bits) repeats_the_bits = abs(state(1)%theta - state(2)%theta) <= 0 &
            .and. abs(forces(1)%frame_shear - forces(2)%frame_shear) <= 0 &
            .and. abs(forces(1)%link - forces(2)%link) <= 0
         if (.not. repeats_the_bits) exit
      end do
      call destroy_stepping(wall)
   end function repeats_the_bits

end module hosts
